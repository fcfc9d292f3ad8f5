"""How a recording is laid out when it is opened: the robot large, curves in tabs beside it."""

from collections.abc import Sequence

import rerun.blueprint as rrb

from sim.columns import TIMELINE
from sim.panels import Tab
from sot.robot import Robot


def layout(robot: Robot, tabs: Sequence[Tab], conflicts: bool) -> rrb.Blueprint:
    """Blueprint of a run of this robot with these tabs of plots, the first of them open, and one of its conflicts."""
    told = [rrb.TextLogView(origin="conflicts", name="Conflicts")] if conflicts else []
    beside = rrb.Tabs(
        *(rrb.Vertical(*(plot.view() for plot in tab.plots), name=tab.name) for tab in tabs),
        *told,
        rrb.TextDocumentView(origin="about", name="About"),
        active_tab=0,
    )
    scene = rrb.Spatial3DView(
        origin="world",
        name=robot.label,
        eye_controls=rrb.EyeControls3D(position=[3.3, -0.8, 1.35], look_target=[0.0, 0.0, 0.72]),
        line_grid=False,
        background=[24, 26, 31],
    )
    return rrb.Blueprint(
        rrb.Horizontal(scene, beside, column_shares=[3, 2]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="playing", loop_mode="all"),
    )
