"""Pictures of dancer and robot side by side, at the moments at which the dancer's legs do most: what became of them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from scenarios.hammam2015.key_point_reference import ClipPart
from scenarios.replay import ProgressCallback, Replay, dance
from sim.log import nearest_frames
from sim.reporting import figures
from sim.reporting.chart import Curve, Panel, write_panels
from sot.motion.human.human import SEGMENTS, SIDES
from sot.motion.leg_likeness import foot_lifts
from sot.motion.likeness import hip_heading

Array = NDArray[np.float64]
Points = Mapping[str, Array]

CLIPS = (ClipPart("kick"), ClipPart("lafan1_dance1_subject2", 0.0, 20.0), ClipPart("cmu_01_01"))
MOMENTS, MIN_APART_S = 6, 0.6
VIEW_RAD = 0.9  # from which both are seen, from ahead to the left
BESIDE_LEGS = 2.2  # leg lengths from the dancer to the robot
COLORS = {"dancer": "#4a6fa5", "robot": "#d9722a"}
PANEL_PX = (300.0, 300.0)
LINES = (
    *SEGMENTS.values(),
    ("left_hip", "right_hip"),
    ("left_shoulder", "right_shoulder"),
    *((f"{side}_ankle", f"{side}_toe") for side in SIDES),
)
SHOWN = ("leg_segment_deg", "knee_bend_deg", "foot_lift_ratio", "heading_deg")


def study(rate: float, out: Path, tell: ProgressCallback, parts: Sequence[ClipPart] = CLIPS) -> dict[str, Any]:
    """Dance clips under physics, and draw each; returns the figures of likeness, clip by clip.

    Args:
        rate: of the control [Hz].
        out: folder for the pictures.
        tell: told of the progress.
        parts: of clips, three unless given.
    """
    found: dict[str, Any] = {}
    for part in parts:
        danced = dance(Replay(part.clip, feet="auto", start=part.start, duration=part.duration, rate=rate), tell)
        log, plan = danced.run.log.trimmed(), danced.plan
        assert plan is not None
        human, robot = plan.human, plan.motion.robot
        shown = np.flatnonzero((human.times >= plan.start) & (human.times <= min(plan.end, log.ticks * log.period)))
        points = {name: place[shown] for name, place in human.points.items()}
        moments = moments_of(points, human.rate)
        rows = nearest_frames(human.times[shown[moments]], 1.0 / log.period, log.ticks)
        bodies = {
            "dancer": {name: place[moments] for name, place in points.items()},
            "robot": figures.Points.of(robot, log.q[rows]).positions,
        }
        times = human.times[shown[moments]] - plan.start
        panels = [panel_of(bodies, k, f"{t:.1f} s", human.leg) for k, t in enumerate(times.tolist())]
        write_panels(
            out / f"{part.label.replace(' ', '_')}.svg", f"{part.label}: dancer and robot", panels, 3, PANEL_PX
        )
        found[part.label] = figures.likeness(log, plan) | {"fell": danced.info.fell_at_s is not None}
    return found


def show(found: dict[str, Any], console: Console) -> None:
    """Print the figures."""
    table = Table(box=None)
    for head in ("clip", "fell", *SHOWN):
        table.add_column(head)
    for name, own in found.items():
        cells = ("-" if own[key] is None else f"{own[key]:.2f}" for key in SHOWN)
        table.add_row(name, "yes" if own["fell"] else "no", *cells)
    console.print(table)


def moments_of(human: Points, rate: float) -> NDArray[np.int_]:
    """The frames, in order, at which a human lifts its feet highest, some way apart; the rest of them evenly spaced."""
    count, apart = len(human["waist"]), round(MIN_APART_S * rate)
    chosen: list[int] = []
    highest = [
        (lift.height, lift.first + int(human[f"{lift.side}_ankle"][lift.first : lift.last + 1, 2].argmax()))
        for lift in foot_lifts(human)
    ]
    evenly = np.linspace(0, count - 1, MOMENTS + 2).round().astype(int)[1:-1].tolist()
    for frame in [*(frame for _, frame in sorted(highest, reverse=True)), *evenly]:
        if len(chosen) < MOMENTS and all(abs(frame - other) >= apart for other in chosen):
            chosen.append(frame)
    return np.sort(np.array(chosen))


def panel_of(bodies: Mapping[str, Points], moment: int, title: str, leg: float) -> Panel:
    """The bodies at one moment, side by side, each seen as it faces."""
    curves = []
    for k, (name, body) in enumerate(bodies.items()):
        heading = float(hip_heading(body)[moment]) - VIEW_RAD
        right, waist = np.array([-np.sin(heading), np.cos(heading)]), body["waist"][moment]
        lowest = min(body[f"{side}_ankle"][moment, 2] for side in SIDES)
        for near, far in LINES:
            if near in body and far in body:
                ends = np.array([body[near][moment], body[far][moment]])
                across = -(ends[:, :2] - waist[:2]) @ right + k * BESIDE_LEGS * leg
                curves.append(Curve(across, ends[:, 2] - lowest, COLORS[name], width=2.2))
    return Panel(title, "m", "m", curves, equal=True)
