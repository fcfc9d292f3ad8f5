"""Ramos 2011, Figures 3 and 5 to 8, of our own dances: pictures, and a recording of the robots side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from scenarios.ramos_edits import HAND, KNEES, Knee, dancers_height, knee_joint
from sim.blueprint import layout
from sim.bodies import send_robot
from sim.chart import Curve, Panel, write
from sim.columns import COLORS
from sim.figures import Points
from sim.log import RunLog, nearest_frames
from sim.panels import FRAME_RATE, MM, MODES, Tab, changes
from sim.plots import Curves, Plot, States
from sim.recorder import recording
from sim.shapes import read_shapes
from sim.visuals import BONES, send_floor, send_human, send_name
from sot.motion.plan import PLAN_RATE, Plan
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]

SIDE = 1.2
"""Between two dancers of the recording [m]."""
MOMENTS = 7
"""Thumbnails a dancer."""
APART = 1.1
"""Between two of them [m]."""
SHADES = {"dancer": "#777", "geometric": "#d9762b", "posture": "#3a9a5b", "final": "#2b6fd9"}
DRAWN_RATE = 50.0
MARGIN = 1.5
"""Of time around what a picture is about [s]."""


@dataclass(frozen=True)
class Three:
    """The three dances of a clip.

    Attributes:
        planned: the dancer, and the motion whose balance is kept.
        geometric: the copy that is not balanced.
        posture, final: the runs under physics, without and with edits.
        knees, raised, slid: what was edited: the knees' oscillations, when the hand is raised, and when a foot slides
            [s].
    """

    planned: Plan
    geometric: Motion
    posture: RunLog
    final: RunLog
    knees: Sequence[Knee]
    raised: Sequence[tuple[float, float]]
    slid: Sequence[tuple[float, float]]

    @property
    def dances(self) -> dict[str, tuple[Array, Array]]:
        """Times (T,) [s] and configurations (T, nq) of each robot at about `FRAME_RATE`."""
        rows = {name: log.rows_at(FRAME_RATE) for name, log in (("posture", self.posture), ("final", self.final))}
        every = max(1, round(self.geometric.rate / FRAME_RATE))
        return {
            "geometric": (self.geometric.times[::every], self.geometric.q[::every]),
            "posture": (self.posture.time[rows["posture"]], self.posture.q[rows["posture"]]),
            "final": (self.final.time[rows["final"]], self.final.q[rows["final"]]),
        }


def draw_thumbnails(path: Path, three: Three, title: str) -> None:
    """Figure 3: the dancer and the three robots at the same moments, from the front."""
    robot, human = three.geometric.robot, three.planned.human
    middle = 0.5 * (three.planned.end - three.planned.start) / MOMENTS
    moments = three.planned.start + middle * (1.0 + 2.0 * np.arange(MOMENTS))
    rows: dict[str, Mapping[str, Array]] = {"dancer": human.points}
    frames = {"dancer": nearest_frames(moments, human.rate, human.count)}
    for name, (times, q) in three.dances.items():
        nearest = np.abs(times[:, None] - moments).argmin(axis=0)
        rows[name], frames[name] = Points.of(robot, q[nearest]).positions, np.arange(MOMENTS)
    panels = []
    for name, points in rows.items():
        curves = []
        for k, frame in enumerate(frames[name].tolist()):
            for near, far in BONES:
                if near not in points or far not in points:
                    continue
                ends = np.array([points[near][frame], points[far][frame]])
                across = k * APART - (ends[:, 1] - points["waist"][frame][1])
                curves.append(Curve(across, ends[:, 2], SHADES[name], width=2.0))
        panels.append(Panel(name, "m, seen from the front", "m", curves, equal=True))
    write(path, f"{title} at {', '.join(f'{t:.0f}' for t in moments)} s", panels, 2)


def draw_curves(path: Path, three: Three, title: str) -> None:
    """Figures 5a, 6a, 6b, 7 and 8 of the parts of the dance that were edited most."""
    robot = three.geometric.robot
    runs = {"posture": three.posture, "final": three.final}
    end = three.planned.motion.duration
    longest = max(three.knees, key=lambda knee: knee.swing.amplitude, default=None)
    point = longest.point if longest else KNEES[-1]
    column = 7 + knee_joint(robot, point)
    around = (longest.swing.start - MARGIN, longest.swing.end + MARGIN) if longest else (0.0, end)
    raised = max(three.raised, key=lambda span: span[1] - span[0], default=(0.0, end))
    signals = {"demonstrated": _sampled(three.geometric.times, three.geometric.q, "geometric")}
    signals |= {name: _sampled(log.time, log.q, name) for name, log in runs.items()}
    places = {name: Points.of(robot, q, (point, HAND)).positions for name, (_, q, _) in signals.items()}
    wanted = dancers_height(three.planned)

    def shown(value: Mapping[str, Array], span: tuple[float, float]) -> list[Curve]:
        return [_within(times, value[name], span, color, name) for name, (times, _, color) in signals.items()]

    angles = {name: np.rad2deg(q[:, column]) for name, (_, q, _) in signals.items()}
    knee = point.replace("_", " ")
    whole = [Curve(signals["demonstrated"][0], angles["demonstrated"], SHADES["geometric"], "demonstrated")]
    for one in three.knees:
        if one.point == point:
            inside = (one.swing.start, one.swing.end)
            label = f"{one.swing.frequency:.2f} Hz"
            whole.append(_within(signals["demonstrated"][0], angles["demonstrated"], inside, "#222", label))
    x = {name: MM * place[point][:, 0] for name, place in places.items()}
    z = {name: MM * place[HAND][:, 2] for name, place in places.items() if name != "demonstrated"}
    dancer = _within(np.arange(len(wanted)) / PLAN_RATE, MM * wanted, raised, SHADES["dancer"], "dancer")
    hand = [_within(signals[name][0], z[name], raised, SHADES[name], name) for name in z]
    panels = [
        Panel(f"5a: {knee}, where it oscillates", "s", "deg", whole),
        Panel(f"6a: {knee}, joint", "s", "deg", shown(angles, around)),
        Panel(f"6b: {knee}, along X", "s", "mm", shown(x, around)),
        Panel("7: right hand, height", "s", "mm", [dancer, *hand]),
        Panel("8: ZMP along Y, and the soles", "s", "mm", _zmp(three)),
    ]
    write(path, title, panels, 2)


def _zmp(three: Three) -> list[Curve]:
    """Figure 8: the ZMP across the feet around the first slide, in both runs, with the edges of the soles."""
    motion = three.planned.motion
    start, end = three.slid[0] if three.slid else (0.0, motion.duration)
    span = (start - MARGIN, end + MARGIN)
    curves: list[Curve] = []
    for foot, pose in motion.phases[0].feet.items():
        edges = np.array([pose.act(corner)[1] for corner in motion.robot.sole(foot)])
        for edge in (edges.min(), edges.max()):
            label = "soles" if not curves else ""
            curves.append(Curve(np.array(span), np.full(2, MM * edge), "#c33", label, dashed=True, width=1.0))
    for name, log in (("posture", three.posture), ("final", three.final)):
        curves.append(_within(log.time, MM * log.zmp_measured[:, 1], span, SHADES[name], name))
    curves += [Curve(np.full(2, t), MM * np.array([-0.2, 0.2]), "#222", "", width=1.0) for t in (start, end)]
    return curves


def record(path: Path, three: Three, title: str) -> None:
    """The dancer, the geometric copy, the posture task and the final dance side by side, with their curves."""
    motion, robot, shapes = three.planned.motion, three.geometric.robot, read_shapes(three.geometric.robot)
    panels = _tabs(three)
    with recording(path, title, ABOUT.format(title=title), layout(motion, panels, aside=SIDE)) as columns:
        columns.static("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        send_floor(columns, motion, 1.5 * SIDE)
        human, times = three.planned.human, three.dances["final"][0]
        send_human(columns, human, times)
        waist = human.points["waist"][nearest_frames(times, human.rate, human.count)]
        send_name(columns, "world/human", "dancer", times, waist[:, :2])
        columns.static("world/human", rr.Transform3D(translation=[0.0, -1.5 * SIDE, 0.0]))
        for k, (name, (times, q)) in enumerate(three.dances.items()):
            ghost = COLORS["ghost"] if name == "geometric" else None
            send_robot(columns, f"world/{name}", robot, shapes, times, q, ghost=ghost)
            send_name(columns, f"world/{name}", name, times, q[:, :2])
            columns.static(f"world/{name}", rr.Transform3D(translation=[0.0, (k - 0.5) * SIDE, 0.0]))
        for tab in panels:
            for plot in tab.plots:
                plot.send(columns)


ABOUT = """# {title}

From left to right: the dancer in the robot's size; the geometric copy, which is not simulated: no robot could do it;
the posture task alone under physics; and the final dance, with its edits.
"""


def _tabs(three: Three) -> list[Tab]:
    robot = three.geometric.robot
    logs = {"posture": three.posture, "final": three.final}
    joints = [knee_joint(robot, knee) for knee in KNEES]

    knees = [
        Plot(
            f"{knee.replace('_', ' ').capitalize()} [deg]",
            ("knees", knee),
            tuple(
                Curves(name, times, np.rad2deg(q[:, 7 + joint]), (name,)) for name, (times, q) in three.dances.items()
            ),
        )
        for knee, joint in zip(KNEES, joints, strict=True)
    ]
    wanted = dancers_height(three.planned)
    heights = [Curves("dancer", np.arange(len(wanted)) / PLAN_RATE, MM * wanted, ("dancer",))]
    heights += [
        Curves(name, times, MM * Points.of(robot, q, (HAND,)).positions[HAND][:, 2], (name,))
        for name, (times, q) in three.dances.items()
    ]
    zmps = [
        Plot(
            f"ZMP {axis} [mm]",
            ("zmp", axis),
            tuple(Curves(name, log.time, MM * log.zmp_measured[:, k], (name,)) for name, log in logs.items()),
        )
        for k, axis in enumerate("xy")
    ]
    modes = {foot: three.final.foot_mode[:, k] for k, foot in enumerate(robot.feet)}
    feet = States("Planned contacts", ("contacts",), three.final.time, modes, MODES, [COLORS[name] for name in MODES])
    hand = Plot("Right hand, height [mm]", ("hand",), tuple(heights))
    return [
        Tab("Knees and hand", (*knees, hand)),
        Tab("Balance", (*zmps, feet)),
        *changes(three.final),
    ]


def _sampled(times: Array, q: Array, shade: str) -> tuple[Array, Array, str]:
    every = max(1, round(1.0 / (DRAWN_RATE * (times[1] - times[0]))))
    return times[::every], q[::every], SHADES[shade]


def _within(times: Array, values: Array, span: tuple[float, float], color: str, label: str) -> Curve:
    inside = (times >= span[0]) & (times <= span[1])
    return Curve(times[inside], values[inside], color, label)
