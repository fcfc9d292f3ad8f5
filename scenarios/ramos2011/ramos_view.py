"""The three dances of Ramos 2011, VI, beside the dancer: a recording of the robots side by side, with their curves."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from scenarios.ramos2011.ramos_edits import HAND, KNEES, KneeOscillation, knee_joint_number
from sim.log import RunLog, nearest_frames
from sim.recording.blueprint import layout
from sim.recording.bodies import send_robot
from sim.recording.columns import COLORS, Color
from sim.recording.panels import FOOT_MODE_NAMES, FRAME_RATE, MM_PER_M, Tab, task_level_tabs
from sim.recording.plots import Curves, Plot, States
from sim.recording.recorder import open_recording
from sim.recording.shapes import read_shapes
from sim.recording.visuals import send_floor, send_human, send_name
from sim.reporting.figures import Points
from sot.motion.plan import PLAN_RATE, Plan
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]

DANCER_COLORS: dict[str, Color] = {
    "dancer": (119, 119, 119),
    "geometric": (217, 118, 43),
    "posture": (58, 154, 91),
    "final": (43, 111, 217),
}
"""Colours of curves, visible on dark and on white."""
DANCER_SPACING = 1.2
"""Distance between two dancers of the recording [m]."""


@dataclass(frozen=True)
class ThreeDances:
    """The three dances of a clip.

    Attributes:
        planned: the dancer, and the motion whose balance is kept.
        geometric: the copy that is not balanced.
        posture, final: the runs under physics, without and with edits.
        dancer_hand_height: height of the dancer's right hand at the knots, in the robot's size (T,) [m].
        knees, raised_spans, slide_spans: what was edited: the knees' oscillations, when the hand is raised, and
            when a foot slides [s].
    """

    planned: Plan
    geometric: Motion
    posture: RunLog
    final: RunLog
    dancer_hand_height: Array
    knees: Sequence[KneeOscillation]
    raised_spans: Sequence[tuple[float, float]]
    slide_spans: Sequence[tuple[float, float]]

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


def write_recording(path: Path, three: ThreeDances, title: str) -> None:
    """The dancer, the geometric copy, the posture task and the final dance side by side, with their curves."""
    motion, robot, shapes = three.planned.motion, three.geometric.robot, read_shapes(three.geometric.robot)
    panels = _tabs(three)
    with open_recording(
        path, title, ABOUT_TEXT.format(title=title), layout(motion, panels, extra_width=DANCER_SPACING)
    ) as columns:
        columns.static("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        send_floor(columns, motion, 1.5 * DANCER_SPACING)
        human, times = three.planned.human, three.dances["final"][0]
        send_human(columns, human, times)
        waist = human.points["waist"][nearest_frames(times, human.rate, human.count)]
        send_name(columns, "world/human", "dancer", times, waist[:, :2])
        columns.static("world/human", rr.Transform3D(translation=[0.0, -1.5 * DANCER_SPACING, 0.0]))
        for k, (name, (times, q)) in enumerate(three.dances.items()):
            ghost = COLORS["ghost"] if name == "geometric" else None
            send_robot(columns, f"world/{name}", robot, shapes, times, q, ghost_color=ghost)
            send_name(columns, f"world/{name}", name, times, q[:, :2])
            columns.static(f"world/{name}", rr.Transform3D(translation=[0.0, (k - 0.5) * DANCER_SPACING, 0.0]))
        for tab in panels:
            for plot in tab.plots:
                plot.send(columns)


ABOUT_TEXT = """# {title}

From left to right: the dancer in the robot's size; the geometric copy, which is not simulated: no robot could do it;
the posture task alone under physics; and the final dance, with its edits.
"""


def _tabs(three: ThreeDances) -> list[Tab]:
    robot = three.geometric.robot
    logs = {"posture": three.posture, "final": three.final}
    joints = [knee_joint_number(robot, knee) for knee in KNEES]

    knees = [
        Plot(
            f"{knee.replace('_', ' ').capitalize()} [deg]",
            ("knees", knee),
            tuple(
                Curves(name, times, np.rad2deg(q[:, 7 + joint]), (name,), (DANCER_COLORS[name],))
                for name, (times, q) in three.dances.items()
            ),
        )
        for knee, joint in zip(KNEES, joints, strict=True)
    ]
    wanted = three.dancer_hand_height
    heights = [
        Curves("dancer", np.arange(len(wanted)) / PLAN_RATE, MM_PER_M * wanted, ("dancer",), (DANCER_COLORS["dancer"],))
    ]
    heights += [
        Curves(
            name, times, MM_PER_M * Points.of(robot, q, (HAND,)).positions[HAND][:, 2], (name,), (DANCER_COLORS[name],)
        )
        for name, (times, q) in three.dances.items()
    ]
    zmps = [
        Plot(
            f"ZMP {axis} [mm]",
            ("zmp", axis),
            tuple(
                Curves(name, log.time, MM_PER_M * log.zmp_measured[:, k], (name,), (DANCER_COLORS[name],))
                for name, log in logs.items()
            ),
        )
        for k, axis in enumerate("xy")
    ]
    modes = {foot: three.final.foot_mode[:, k] for k, foot in enumerate(robot.feet)}
    feet = States(
        "Planned contacts",
        ("contacts",),
        three.final.time,
        modes,
        FOOT_MODE_NAMES,
        [COLORS[name] for name in FOOT_MODE_NAMES],
    )
    hand = Plot("Right hand, height [mm]", ("hand",), tuple(heights))
    return [
        Tab("Knees and hand", (*knees, hand)),
        Tab("Balance", (*zmps, feet)),
        *task_level_tabs(three.final),
    ]
