"""How a recording is laid out when it is opened: the robot large, curves in tabs beside it."""

from collections.abc import Sequence

import numpy as np
import rerun.blueprint as rrb

from sim.recording.columns import TIMELINE
from sim.recording.panels import Tab
from sot.motion.trajectory import Motion

LOOK_AT_HEIGHT = 0.72  # m, height of the point that the eye looks at
DISTANCE_PER_TRAVEL = 0.6  # distance of the eye added per metre that the robot travels
EYE_OFFSET = (3.3, -0.8, 0.63)  # m, from the point looked at to the eye, for a robot that stays in place
EYE_OFFSET_BESIDE = (1.5, -2.9, 1.1)  # m, the same where things stand before the robot


def layout(
    motion: Motion, tabs: Sequence[Tab], conflicts: bool = False, extra_width: float = 0.0, things: bool = False
) -> rrb.Blueprint:
    """Blueprint of a run with these tabs of plots, the first of them open, and a tab of its conflicts if asked for.

    extra_width: how far others dance beside the robot, which the view should include [m].
    things: whether the robot handles things, which would hide it from the front.
    """
    told = [rrb.TextLogView(origin="conflicts", name="Conflicts")] if conflicts else []
    beside = rrb.Tabs(
        *(rrb.Vertical(*(plot.view() for plot in tab.plots), name=tab.name) for tab in tabs),
        *told,
        rrb.TextDocumentView(origin="about", name="About"),
        active_tab=0,
    )
    scene = rrb.Spatial3DView(
        origin="world",
        name=motion.robot.label,
        eye_controls=_eye_controls(motion, extra_width, EYE_OFFSET_BESIDE if things else EYE_OFFSET),
        line_grid=False,
        background=[24, 26, 31],
    )
    return rrb.Blueprint(
        rrb.Horizontal(scene, beside, column_shares=[3, 2]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="playing", loop_mode="all"),
    )


def _eye_controls(motion: Motion, extra_width: float, offset: tuple[float, float, float]) -> rrb.EyeControls3D:
    """Eye that looks at the middle of where the robot goes, from far enough to see it all."""
    low, high = motion.com[:, :2].min(axis=0), motion.com[:, :2].max(axis=0)
    target = np.append(0.5 * (low + high), LOOK_AT_HEIGHT)
    distance = 1.0 + (DISTANCE_PER_TRAVEL * np.linalg.norm(high - low) + extra_width) / np.linalg.norm(offset)
    return rrb.EyeControls3D(position=target + distance * np.array(offset), look_target=target)
