"""Ramos 2011, Figures 3 and 5 to 8, of our own dances: pictures that any browser shows."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.ramos2011 import ramos_view
from scenarios.ramos2011.ramos_edits import HAND, KNEES, knee_joint_number
from scenarios.ramos2011.ramos_view import ThreeDances
from sim.log import nearest_frames
from sim.recording.columns import css_color
from sim.recording.panels import MM_PER_M
from sim.recording.visuals import BONES
from sim.reporting.chart import Curve, Field, Panel, write_panels
from sim.reporting.figures import Points
from sot.motion.human.oscillation import BAND_HZ, Oscillation, find_oscillations
from sot.motion.human.scalogram import scalogram
from sot.motion.plan import PLAN_RATE

Array = NDArray[np.float64]

THUMBNAIL_COUNT = 7
"""Number of thumbnails of each dancer."""
THUMBNAIL_SPACING = 1.1
"""Distance between two thumbnails [m]."""
CSS_COLORS = {name: css_color(shade) for name, shade in ramos_view.DANCER_COLORS.items()}
DRAWN_RATE = 50.0
TIME_MARGIN = 1.5
"""Time shown before and after the event of a picture [s]."""
THUMBNAILS_SIZE_PX = 900.0, 220.0
"""Width and height of a row of thumbnails [pixels]."""
SCALOGRAM_CELLS = 32, 128
"""Number of frequencies and of times in a scalogram's picture."""
PAPER_HZ, PAPER_SPANS, PAPER_DEG = 2.7, ((10.0, 14.0), (31.0, 36.5)), 6.0
"""What the paper reads off its Figure 5, as a made-up knee: frequency [Hz], when [s], and an amplitude [deg]."""


def draw_thumbnails(path: Path, three: ThreeDances, title: str) -> None:
    """Figure 3: the dancer and the three robots at the same moments, from the front."""
    robot, human = three.geometric.robot, three.planned.human
    middle = 0.5 * (three.planned.end - three.planned.start) / THUMBNAIL_COUNT
    moments = three.planned.start + middle * (1.0 + 2.0 * np.arange(THUMBNAIL_COUNT))
    rows: dict[str, Mapping[str, Array]] = {"dancer": human.points}
    frames = {"dancer": nearest_frames(moments, human.rate, human.count)}
    for name, (times, q) in three.dances.items():
        nearest = np.abs(times[:, None] - moments).argmin(axis=0)
        rows[name], frames[name] = Points.of(robot, q[nearest]).positions, np.arange(THUMBNAIL_COUNT)
    panels = []
    for name, points in rows.items():
        curves = []
        for k, frame in enumerate(frames[name].tolist()):
            for near, far in BONES:
                if near not in points or far not in points:
                    continue
                ends = np.array([points[near][frame], points[far][frame]])
                across = k * THUMBNAIL_SPACING - (ends[:, 1] - points["waist"][frame][1])
                curves.append(Curve(across, ends[:, 2], CSS_COLORS[name], width=2.0))
        panels.append(Panel(name, "m, seen from the front", "m", curves, equal=True))
    write_panels(path, f"{title} at {', '.join(f'{t:.0f}' for t in moments)} s", panels, 1, THUMBNAILS_SIZE_PX)


def draw_curves(path: Path, three: ThreeDances, title: str) -> None:
    """Figures 6a, 6b, 7 and 8 of the parts of the dance that were edited most."""
    robot = three.geometric.robot
    runs = {"posture": three.posture, "final": three.final}
    end = three.planned.motion.duration
    longest = max(three.knees, key=lambda knee: knee.oscillation.amplitude, default=None)
    point = longest.point if longest else KNEES[-1]
    column = 7 + knee_joint_number(robot, point)
    around = (longest.oscillation.start - TIME_MARGIN, longest.oscillation.end + TIME_MARGIN) if longest else (0.0, end)
    raised = max(three.raised_spans, key=lambda span: span[1] - span[0], default=(0.0, end))
    signals = {"demonstrated": _sampled_for_drawing(three.geometric.times, three.geometric.q, "geometric")}
    signals |= {name: _sampled_for_drawing(log.time, log.q, name) for name, log in runs.items()}
    places = {name: Points.of(robot, q, (point, HAND)).positions for name, (_, q, _) in signals.items()}
    wanted = three.dancer_hand_height

    def shown(value: Mapping[str, Array], span: tuple[float, float]) -> list[Curve]:
        return [_curve_within(times, value[name], span, color, name) for name, (times, _, color) in signals.items()]

    angles = {name: np.rad2deg(q[:, column]) for name, (_, q, _) in signals.items()}
    knee = point.replace("_", " ")
    x = {name: MM_PER_M * place[point][:, 0] for name, place in places.items()}
    z = {name: MM_PER_M * place[HAND][:, 2] for name, place in places.items() if name != "demonstrated"}
    dancer = _curve_within(
        np.arange(len(wanted)) / PLAN_RATE, MM_PER_M * wanted, raised, CSS_COLORS["dancer"], "dancer"
    )
    hand = [_curve_within(signals[name][0], z[name], raised, CSS_COLORS[name], name) for name in z]
    panels = [
        Panel(f"6a: {knee}, joint", "s", "deg", shown(angles, around)),
        Panel(f"6b: {knee}, X", "s", "mm", shown(x, around)),
        Panel("7: right hand, height", "s", "mm", [dancer, *hand]),
        Panel("8: ZMP along Y", "s", "mm", _zmp_curves(three)),
    ]
    write_panels(path, title, panels, 2)


def _zmp_curves(three: ThreeDances) -> list[Curve]:
    """Figure 8: the ZMP across the feet around the first slide, in both runs, with the edges of the soles."""
    motion = three.planned.motion
    start, end = three.slide_spans[0] if three.slide_spans else (0.0, motion.duration)
    span = (start - TIME_MARGIN, end + TIME_MARGIN)
    curves: list[Curve] = []
    for foot, pose in motion.phases[0].feet.items():
        edges = np.array([pose.act(corner)[1] for corner in motion.robot.sole(foot)])
        for edge in (edges.min(), edges.max()):
            label = "soles" if not curves else ""
            curves.append(Curve(np.array(span), np.full(2, MM_PER_M * edge), "#c33", label, dashed=True, width=1.0))
    for name, log in (("posture", three.posture), ("final", three.final)):
        curves.append(_curve_within(log.time, MM_PER_M * log.zmp_measured[:, 1], span, CSS_COLORS[name], name))
    curves += [Curve(np.full(2, t), MM_PER_M * np.array([-0.2, 0.2]), "#222", "", width=1.0) for t in (start, end)]
    return curves


def draw_scalogram(path: Path, three: ThreeDances, title: str) -> None:
    """Figure 5: each knee's scalogram below its angle, and that of a knee which swings as the paper's does.

    A line is an oscillation that was found: when, and at which frequency.
    """
    motion = three.geometric
    every = max(1, round(motion.rate / DRAWN_RATE))
    times, q = motion.times[::every], motion.q[::every]
    traces = {point: q[:, 7 + knee_joint_number(motion.robot, point)] for point in KNEES}
    panels: list[Panel] = []
    for point, angle in traces.items():
        found = [knee.oscillation for knee in three.knees if knee.point == point]
        panels += _scalogram_panels(point.replace("_", " "), times, angle, found)
    times = np.arange(0.0, 40.0, 1.0 / DRAWN_RATE)
    knee = swinging_knee(times)
    panels += _scalogram_panels("made up, as the paper's", times, knee, find_oscillations(times, knee))
    write_panels(path, f"{title}: scalograms, 0 to the greatest amplitude", panels, 2)


def swinging_knee(times: Array) -> Array:
    """A made-up knee (T,) that swings where and as fast as the paper's does, on a slow bend [rad]."""
    swing = np.zeros(len(times))
    for start, end in PAPER_SPANS:
        swing += np.where((times > start) & (times < end), np.sin(2.0 * np.pi * PAPER_HZ * times), 0.0)
    return np.deg2rad(35.0 + 12.0 * np.sin(2.0 * np.pi * 0.1 * times) + PAPER_DEG * swing)


def _scalogram_panels(name: str, times: Array, angle: Array, found: Sequence[Oscillation]) -> list[Panel]:
    """A knee's angle (T,) and its scalogram, with its oscillations in both."""
    degrees = np.rad2deg(angle)
    trace = [Curve(times, degrees, CSS_COLORS["geometric"])]
    trace += [_curve_within(times, degrees, (one.start, one.end), "#222", "") for one in found]
    seen = scalogram(times, angle, BAND_HZ)
    x, y = (
        np.linspace(span[0], span[-1], count)
        for span, count in ((seen.times, SCALOGRAM_CELLS[1]), (BAND_HZ, SCALOGRAM_CELLS[0]))
    )
    columns = np.searchsorted(seen.times, x).clip(max=len(seen.times) - 1)
    swings = np.rad2deg(np.abs(seen.coefficients[:, columns]))
    values = np.array([np.interp(y, seen.frequencies, column) for column in swings.T]).T
    lines = [Curve(np.array([one.start, one.end]), np.full(2, one.frequency), "#1560d4", width=3.0) for one in found]
    what = ", ".join(f"{one.frequency:.2f} Hz" for one in found) or "no oscillation"
    return [
        Panel(f"5a: {name}", "s", "deg", trace),
        Panel(f"5b: {name}: {what}; to {values.max():.0f} deg", "s", "Hz", lines, field=Field(x, y, values)),
    ]


def _sampled_for_drawing(times: Array, q: Array, shade: str) -> tuple[Array, Array, str]:
    every = max(1, round(1.0 / (DRAWN_RATE * (times[1] - times[0]))))
    return times[::every], q[::every], CSS_COLORS[shade]


def _curve_within(times: Array, values: Array, span: tuple[float, float], color: str, label: str) -> Curve:
    inside = (times >= span[0]) & (times <= span[1])
    return Curve(times[inside], values[inside], color, label)
