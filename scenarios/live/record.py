"""What is left of a live run: the human whom the robot followed, and the figures of the stream."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log import RunLog
from sim.reporting.figures import Points
from sot.live.follower import EASE_IN_TIME, Follower
from sot.live.steps.follower import SteppingFollower
from sot.motion.feet.flight import Flight
from sot.motion.feet.path import path_length
from sot.motion.feet.travel import MIN_FOOTFALL_LENGTH, Footfall
from sot.motion.human.human import SIDES, Human, nearest_rotations
from sot.motion.likeness import UPPER_SEGMENTS, hip_heading, mean_segment_angle_deg
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]

HUMAN_RATE = 50.0
"""Frames a second of the recorded human [Hz]."""
LAG_STEP, MAX_LAG = 0.01, 0.6
"""Lags that are tried, and the greatest [s]."""


@dataclass(frozen=True)
class LiveWay:
    """A person's steps while the robot stepped, too: a `sot.motion.performance.Way`."""

    footfalls: Sequence[Footfall]
    path: float
    scale: float = 1.0

    @classmethod
    def of(cls, follower: SteppingFollower, end: float) -> "LiveWay":
        """What a follower saw and made up to a time [s]; a place is that which the robot had decided on."""
        made = {id(step.asked): step for step in follower.footing.made}
        falls = []
        for asked in follower.asked:
            length = np.hypot(asked.place.x - asked.start.x, asked.place.y - asked.start.y)
            if asked.has_landed and asked.land < end and length > MIN_FOOTFALL_LENGTH:
                step = made.get(id(asked))
                place = (step.place.x, step.place.y) if step else (nan, nan)
                falls.append(Footfall(asked.foot, place, step.land if step else None))
        seen = [(t, place) for t, place in follower.way if t < end]
        if len(seen) < 2:
            return cls(falls, 0.0)
        at, places = np.array([t for t, _ in seen]), np.array([place for _, place in seen])
        times = np.arange(at[0], at[-1], 1.0 / HUMAN_RATE)
        way = np.column_stack([np.interp(times, at, column) for column in places.T])
        return cls(falls, path_length(way, HUMAN_RATE))


@dataclass(frozen=True)
class LiveRecord:
    """How a live reference came from a human: a `sot.motion.performance.Performance`."""

    motion: Motion
    human: Human
    start: float
    end: float
    clock: Array
    remarks: Sequence[str] = ()
    travel: LiveWay | None = None
    flights: Sequence[Flight] = ()
    speed_min: float = 1.0
    added_time: float = 0.0

    @property
    def heading(self) -> Array:
        """Which way the human faces, once placed before the robot."""
        return hip_heading(self.human.points)

    @property
    def retarget(self) -> dict[str, float | None]:
        """Nothing was planned."""
        return {"key_point_rms_m": None, "frames_per_s": None}


def record_of(follower: Follower, motion: Motion) -> LiveRecord | None:
    """The record of a run, None if nobody was seen for long enough."""
    seen = [(t, targets) for t, targets in follower.shown if 0.0 <= t <= motion.duration]
    if len(seen) < 2 or seen[-1][0] - seen[0][0] < 2.0 * EASE_IN_TIME:
        return None
    at = np.array([t for t, _ in seen])
    times = np.arange(int(motion.duration * HUMAN_RATE) + 1) / HUMAN_RATE

    def resampled(values: Array) -> Array:
        flat = values.reshape(len(values), -1)
        columns = [np.interp(times, at, flat[:, k]) for k in range(flat.shape[1])]
        return np.stack(columns, axis=1).reshape(len(times), *values.shape[1:])

    points = {name: resampled(np.array([targets.points[name] for _, targets in seen])) for name in seen[0][1].points}
    frames = {
        body: nearest_rotations(resampled(np.array([targets.frames[body] for _, targets in seen])))
        for body in seen[0][1].frames
    }
    human = Human(follower.source.name, HUMAN_RATE, points, frames)
    start, end = float(at[0]) + EASE_IN_TIME, float(at[-1])
    way = LiveWay.of(follower, motion.duration) if isinstance(follower, SteppingFollower) else None
    return LiveRecord(motion, human, start, end, times, _remarks(follower), way)


def _remarks(follower: Follower) -> list[str]:
    told = []
    if follower.held_s > 0.0:
        told.append(
            f"No frame to follow came for {follower.held_s:.1f} s in all; meanwhile the robot held its pose, and"
            " eased to a safe one."
        )
    return told


def live_figures(follower: Follower, log: RunLog, record: LiveRecord | None, behind: Array) -> dict[str, Any]:
    """The block `live` of the report.

    Args:
        follower: of the run.
        log: of the run.
        record: of the run.
        behind: how far each tick was behind the wall clock when it began [s], (T,); none where nobody kept time.
    """
    return {
        "source": follower.source.name,
        "frames": dict(sorted(follower.counts.items())),
        "time_line": dict(sorted(follower.time_line.counts.items())),
        "packets": dict(sorted(follower.source.counts.items())),
        "held_s": follower.held_s,
        "latency_ms": latencies(follower, log),
        "lag_ms": None if record is None else hand_lag_ms(record, log, follower.time_line.delay),
        "upper_segments": None if record is None else upper_segment_lag(record, log),
        "behind_ms": _spread(1e3 * behind),
        "late_ticks": float(np.mean(behind > log.period)) if len(behind) else None,
    }


def latencies(follower: Follower, log: RunLog) -> dict[str, dict[str, float | None]]:
    """Latency by stage [ms]: "received" since the person was there, all others since the frame was received."""
    passed, period = follower.frame_times, log.period
    rows = np.array([min(round(one.t / period), log.ticks - 1) for one in passed], dtype=int)
    filtered = np.array([one.filtered - one.taken for one in passed])
    solved = np.array([one.solved - one.taken for one in passed])
    knot = np.array([follower.reference.next_knot_after(one.t) - one.t for one in passed])
    commanded = knot + solved + (1e-6 * log.tick_us[rows] if len(rows) else 0.0)
    return {
        "received": _spread(1e3 * np.array([one.age for one in passed])),
        "filtered": _spread(1e3 * filtered),
        "solved": _spread(1e3 * solved),
        "commanded": _spread(1e3 * commanded),
        "measured": _spread(1e3 * (commanded + period)),
    }


def hand_lag_ms(record: LiveRecord, log: RunLog, delay: float) -> float | None:
    """Lag of the robot's hands behind the person's [ms], by which their ways agree best.

    The record has the person at the times at which it is played, a delay [s] after it was there.
    """
    human, robot = record.human, record.motion.robot
    least = max(record.start, delay)
    shown = np.flatnonzero((human.times >= least) & (human.times <= min(record.end, log.time[-1] - MAX_LAG)))
    if len(shown) < HUMAN_RATE:
        return None
    names = ("waist", *(f"{side}_wrist" for side in SIDES))
    wanted = _hands({name: human.points[name][shown] for name in names})
    best, lag = -np.inf, 0.0
    for tried in np.arange(-delay, MAX_LAG, LAG_STEP):
        rows = np.round((human.times[shown] + tried) / log.period).astype(int)
        agreement = float(np.sum(wanted * _hands(Points.of(robot, log.q[rows], names).positions)))
        if agreement > best:
            best, lag = agreement, tried
    return 1e3 * (delay + lag)


def upper_segment_lag(record: LiveRecord, log: RunLog) -> dict[str, float] | None:
    """How much of the upper segments' error is lateness, and how much is left of it.

    Returns:
        "deg", the mean angle to the person as it is played; "lag_ms", by which the robot is behind it where they agree
        best; "deg_at_lag", the mean angle then. None where less than a second can be compared.
    """
    human, robot = record.human, record.motion.robot
    last = min(record.end, log.time[-1]) - MAX_LAG
    shown = np.flatnonzero((human.times >= record.start) & (human.times <= last))
    if len(shown) < HUMAN_RATE:
        return None
    wanted = {name: points[shown] for name, points in human.points.items()}
    steps = round(MAX_LAG * HUMAN_RATE)
    times = human.times[shown[0]] + np.arange(len(shown) + steps) / HUMAN_RATE
    made = Points.of(robot, log.q[np.round(times / log.period).astype(int).clip(0, log.ticks - 1)]).positions
    angles = [
        mean_segment_angle_deg(
            wanted, {name: points[k : k + len(shown)] for name, points in made.items()}, UPPER_SEGMENTS
        )
        for k in range(steps + 1)
    ]
    best = int(np.argmin(angles))
    return {"deg": angles[0], "lag_ms": 1e3 * best / HUMAN_RATE, "deg_at_lag": angles[best]}


def _hands(points: Any) -> Array:
    """Way of both hands from the waist (T, 6), without its mean, of unit size."""
    way = np.hstack([points[f"{side}_wrist"] - points["waist"] for side in SIDES])
    way -= way.mean(axis=0)
    return np.asarray(way / max(float(np.linalg.norm(way)), 1e-12))


def _spread(values: Array) -> dict[str, float | None]:
    if not len(values):
        return {"p50": None, "p95": None, "max": None}
    return {
        "p50": float(np.percentile(values, 50)),
        "p95": float(np.percentile(values, 95)),
        "max": float(values.max()),
    }
