"""How a recording is laid out when it is opened: the robot large, curves in tabs beside it."""

import rerun as rr
import rerun.blueprint as rrb

from sim.columns import TIMELINE
from sim.log import RunLog
from sot.robot import Robot

LIMBS = {
    "left_leg": ("left_leg",),
    "right_leg": ("right_leg",),
    "trunk": ("chest", "head"),
    "left_arm": ("left_arm",),
    "right_arm": ("right_arm",),
}
"""Tab of joint curves -> joint groups in it."""


def layout(robot: Robot, log: RunLog) -> rrb.Blueprint:
    """Blueprint of a run of this robot with these levels."""
    tabs = rrb.Tabs(
        _balance(),
        *(_joints(robot, limb) for limb in LIMBS),
        _tasks(log),
        _ticks(),
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
        rrb.Horizontal(scene, tabs, column_shares=[3, 2]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="playing", loop_mode="all"),
    )


def _balance() -> rrb.Vertical:
    return rrb.Vertical(
        rrb.TimeSeriesView(origin="balance/x", name="ZMP x in the planned support [mm]"),
        rrb.TimeSeriesView(origin="balance/y", name="ZMP y in the planned support [mm]"),
        rrb.TimeSeriesView(origin="balance/com_error", name="Centre of mass minus reference [mm]"),
        rrb.TimeSeriesView(origin="balance/load", name="Normal force on each foot [N]"),
        name="Balance",
    )


def _joints(robot: Robot, limb: str) -> rrb.Vertical:
    greatest = 1.05 * max(robot.effort[joint] for group in LIMBS[limb] for joint in robot.groups[group])
    origin = f"joints/{limb}"
    return rrb.Vertical(
        rrb.TimeSeriesView(origin=f"{origin}/angle", name="Angle [deg]"),
        rrb.TimeSeriesView(origin=f"{origin}/room", name="Room to the nearer limit [deg]"),
        rrb.TimeSeriesView(origin=f"{origin}/error", name="Angle minus reference [deg]"),
        rrb.TimeSeriesView(
            origin=f"{origin}/torque", name="Torque [N m]", axis_y=rrb.ScalarAxis(range=[-greatest, greatest])
        ),
        name=limb.replace("_", " ").capitalize(),
    )


def _tasks(log: RunLog) -> rrb.Vertical:
    return rrb.Vertical(
        *(
            rrb.TimeSeriesView(origin=rr.new_entity_path(["tasks", level]), name=f"{level}: error [{unit}]")
            for level, unit in zip(log.level_names, log.level_units, strict=True)
        ),
        name="Tasks",
    )


def _ticks() -> rrb.Vertical:
    return rrb.Vertical(
        rrb.TimeSeriesView(origin="tick/time", name="Time of a tick [µs]"),
        rrb.TimeSeriesView(origin="tick/slack", name="Slack of each level"),
        rrb.TimeSeriesView(origin="tick/active", name="Active inequality rows of each level"),
        rrb.TimeSeriesView(origin="tick/status", name="Status: 0 solved, 1 second solver, 2 relaxed, 3 failed"),
        rrb.TimeSeriesView(origin="tick/residual", name="Residual of what had to hold"),
        name="Ticks",
    )
