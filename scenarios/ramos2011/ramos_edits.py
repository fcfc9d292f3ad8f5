"""The edits of Ramos 2011, VI: the oscillation of the knees, and the right hand raised to the dancer's height."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from sim.log import RunLog
from sim.reporting.figures import Points
from sot.motion.body.coordinates import to_configuration
from sot.motion.edit import Edit
from sot.motion.human.human import SEGMENTS
from sot.motion.human.oscillation import Oscillation, find_oscillations
from sot.motion.plan import PLAN_RATE, Plan
from sot.robots.robot import Robot
from sot.smooth import low_passed

Array = NDArray[np.float64]
Span = tuple[float, float]

KNEES = ("left_knee", "right_knee")
SIDE = "right"
HAND, WRIST = f"{SIDE}_hand", f"{SIDE}_wrist"
OSCILLATION_BAND_FACTORS = 0.6, 1.6
"""Lower and upper end of an oscillation's band, relative to its frequency."""
HAND_TOO_LOW = 0.02
"""Height below the dancer's at which a hand is too low [m]."""
EDIT_LEAD_TIME, MAX_MERGED_GAP = 0.3, 1.0
"""Time that an edit begins earlier and ends later than its cause; gap below which two edits become one [s]."""
SLIDE_SEPARATION = 0.5
"""Time before and after a slide in which no other edit acts [s]."""
MIN_SWINGS = 2.0
"""Least number of swings of an oscillation."""
HAND_CUTOFF_HZ = 4.0
"""Cut-off frequency of the height that a raised hand follows [Hz]."""


@dataclass(frozen=True)
class KneeOscillation:
    """An oscillation of a knee in the geometric motion: `point`, number of its `joint`, and its `swing` [rad]."""

    point: str
    joint: int
    oscillation: Oscillation


def oscillating_knees(planned: Plan, slides: Sequence[Span]) -> list[KneeOscillation]:
    """The knees' oscillations in the geometric motion while the clip plays and no foot slides, in order of time."""
    robot, y = planned.motion.robot, planned.imitation.knots
    times = np.arange(len(y)) / PLAN_RATE
    shown = (times >= planned.start) & (times <= planned.end)
    knees = []
    for point in KNEES:
        joint = knee_joint_number(robot, point)
        for one in find_oscillations(times[shown], y[shown, 6 + joint]):
            knees += [
                KneeOscillation(point, joint, replace(one, start=start, end=end))
                for start, end in spans_without_slides([(one.start, one.end)], slides)
                if (end - start) * one.frequency >= MIN_SWINGS
            ]
    return sorted(knees, key=lambda knee: knee.oscillation.start)


def knee_joint_number(robot: Robot, point: str) -> int:
    """Number of the joint at a knee."""
    return robot.joints.index(robot.model.names[robot.model.frames[robot.point(point)].parentJoint])


def knee_edits(planned: Plan, knees: Sequence[KneeOscillation]) -> list[Edit]:
    """A task on each knee while it oscillates, Ramos VI-A: its planned way, and the swing that the plan has smoothed
    away."""
    robot, geometric = planned.motion.robot, planned.imitation.knots
    lost = geometric[:, 6:] - balanced_knots(planned)[: len(geometric), 7:]
    edits = []
    for joint in sorted({knee.joint for knee in knees}):
        swings = [knee.oscillation for knee in knees if knee.joint == joint]
        frequencies = [one.frequency for one in swings]
        by = smooth_curve(oscillating_part(lost[:, joint], PLAN_RATE, min(frequencies), max(frequencies)))
        for start, end in spans_without_slides(
            merged_spans([(one.start, one.end) for one in swings], planned), slide_spans(planned)
        ):
            edits.append(Edit(robot.joints[joint], by=by, start=start, end=end))
    return edits


def dancer_hand_height(planned: Plan) -> Array:
    """Height of the right hand at the knots if the robot's arm pointed as the dancer's does (T,) [m]."""
    robot, human = planned.motion.robot, planned.human
    shoulder, elbow = f"{SIDE}_shoulder", f"{SIDE}_elbow"
    rest = Points.of(robot, robot.rest[None], (shoulder, elbow, WRIST)).positions
    now = Points.of(robot, to_configuration(planned.imitation.knots), (shoulder, HAND, WRIST)).positions
    count = len(now[HAND])
    wrist = now[shoulder][:, 2].copy()
    for segment in (f"{SIDE}_upper_arm", f"{SIDE}_forearm"):
        near, far = SEGMENTS[segment]
        wrist += np.linalg.norm(rest[far] - rest[near]) * human.segment_direction(segment)[:count, 2]
    return wrist + now[HAND][:, 2] - now[WRIST][:, 2]


def hand_height(log: RunLog, robot: Robot) -> tuple[Array, Array]:
    """Height of the right hand during a run: times and heights at PLAN_RATE [s, m]."""
    rows = log.rows_at(PLAN_RATE)
    return log.time[rows], Points.of(robot, log.q[rows], (HAND,)).positions[HAND][:, 2]


def low_hand_spans(planned: Plan, wanted: Array, log: RunLog) -> list[Span]:
    """Spans (start, end) [s] in which the hand of a run is lower than wanted, the dancer's height (T,) [m]."""
    times = np.arange(len(wanted)) / PLAN_RATE
    shown = (times >= planned.start) & (times <= planned.end)
    low = (wanted - np.interp(times, *hand_height(log, planned.motion.robot)) > HAND_TOO_LOW) & shown
    return merged_spans([(t, t) for t in times[low].tolist()], planned)


def slide_spans(planned: Plan) -> list[Span]:
    """Spans (start, end) in which a foot slides [s]."""
    return [(phase.start, phase.end) for phase in planned.motion.phases if phase.sliding]


def spans_without_slides(spans: Sequence[Span], slides: Sequence[Span]) -> list[Span]:
    """The parts of spans (start, end) that are clear of slides by SLIDE_SEPARATION [s]."""
    left = list(spans)
    for begins, ends in slides:
        parts = [
            ((start, min(end, begins - SLIDE_SEPARATION)), (max(start, ends + SLIDE_SEPARATION), end))
            for start, end in left
        ]
        left = [part for both in parts for part in both if part[1] - part[0] > 2.0 * EDIT_LEAD_TIME]
    return left


def merged_spans(spans: Sequence[Span], planned: Plan) -> list[Span]:
    """Spans (start, end) with some time around them, one for those within MAX_MERGED_GAP, inside the motion."""
    made: list[Span] = []
    for start, end in sorted(spans):
        if made and start - made[-1][1] <= MAX_MERGED_GAP:
            made[-1] = made[-1][0], max(made[-1][1], end)
        else:
            made.append((start, end))
    return [
        (max(start - EDIT_LEAD_TIME, 0.0), min(end + EDIT_LEAD_TIME, planned.motion.duration)) for start, end in made
    ]


def hand_edits(planned: Plan, spans: Sequence[Span]) -> list[Edit]:
    """The right hand raised to where the dancer's was, Ramos VI-B."""
    wanted = dancer_hand_height(planned)
    own = Points.of(planned.motion.robot, balanced_knots(planned)[: len(wanted)], (HAND,)).positions[HAND][:, 2]
    by = smooth_curve(low_passed(wanted - own, PLAN_RATE, HAND_CUTOFF_HZ))
    return [Edit(HAND, "z", by=by, start=start, end=end, limb_only=True) for start, end in spans]


def smooth_curve(values: Array) -> Callable[[float], float]:
    """A smooth curve through values (T,) at the knots."""
    spline = CubicSpline(np.arange(len(values)) / PLAN_RATE, values)
    return lambda t: float(spline(t))


def balanced_knots(planned: Plan) -> Array:
    """Configurations of the balanced motion at PLAN_RATE (T, nq)."""
    motion = planned.motion
    rows = np.round(np.arange(round(motion.duration * PLAN_RATE) + 1) * motion.rate / PLAN_RATE).astype(int)
    return motion.q[rows.clip(max=len(motion.q) - 1)]


def oscillating_part(values: Array, rate: float, lowest: float, highest: float | None = None) -> Array:
    """The part of a signal (T,) at a rate [Hz] that oscillates at about a frequency, or from one to another [Hz]."""
    low, high = OSCILLATION_BAND_FACTORS[0] * lowest, OSCILLATION_BAND_FACTORS[1] * (highest or lowest)
    return sosfiltfilt(butter(2, (low, min(high, 0.45 * rate)), "bandpass", fs=rate, output="sos"), values)


def oscillation_amplitude(times: Array, angle: Array, oscillation: Oscillation) -> float:
    """Amplitude of an oscillation in a signal (T,), evenly sampled: √2 of the root mean square while it lasts."""
    rate = (len(times) - 1) / (times[-1] - times[0])
    inside = (times >= oscillation.start) & (times <= oscillation.end)
    return float(np.sqrt(2.0 * np.mean(oscillating_part(angle, rate, oscillation.frequency)[inside] ** 2)))
