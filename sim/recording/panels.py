"""The plots of a run, in tabs: balance, servos, joints, tasks, ticks."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.estimation.errors import rotation_errors, world_velocity
from sim.log import RunLog, nearest_frames
from sim.recording.columns import COLORS, SERIES_COLORS
from sim.recording.plots import Curves, Plot, States
from sim.support import ground_heights, support_extents
from sot.gravity import GRAVITY
from sot.motion.performance import Performance
from sot.motion.plan import PLAN_RATE
from sot.motion.trajectory import Motion
from sot.robots.robot import GROUPS, Robot

FRAME_RATE = 60.0  # Hz, of the 3D view and of what is only looked at; other curves keep the control rate
MM_PER_M = 1e3
SLOWED_BELOW_SPEED = 0.999  # share of the dancer's speed; a run above it counts as not slowed down
FOOT_MODE_NAMES = ("off", "fixed", "sliding", "rolling")
"""Names of `RunLog.foot_mode`: `FOOT_OFF`, `FOOT_FIXED`, `FOOT_SLIDING`, `FOOT_ROLLING`."""
LIMB_GROUPS = {
    "left_leg": ("left_leg",),
    "right_leg": ("right_leg",),
    "trunk": ("chest", "head"),
    "left_arm": ("left_arm",),
    "right_arm": ("right_arm",),
}
"""Tab of joint curves -> joint groups in it."""


@dataclass(frozen=True)
class Tab:
    """Plots shown together."""

    name: str
    plots: tuple[Plot | States, ...]


def run_tabs(log: RunLog, motion: Motion, plan: Performance | None) -> list[Tab]:
    """All plots of a run in tabs; the most important come first."""
    joints = [_joints_tab(log, motion, limb) for limb in LIMB_GROUPS]
    slowed = [_speed_tab(plan)] if plan is not None and plan.speed_min < SLOWED_BELOW_SPEED else []
    return [
        _balance_tab(log, motion),
        _center_of_mass_tab(log, motion),
        *_estimate_tabs(log),
        *servo_tabs(log, motion.robot),
        *task_level_tabs(log),
        *slowed,
        *joints,
        _tasks_tab(log),
        _ticks_and_solver_tab(log),
    ]


def divergent_component(com: np.ndarray, velocity: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Divergent component of motion ξ = c + ċ/ω (T, 2), ω² = g / height, of CoM positions and velocities (T, 3)."""
    return com[:, :2] + velocity[:, :2] * np.sqrt(height / GRAVITY)[:, None]


def measured_and_planned_dcm(log: RunLog, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Measured and planned divergent component of motion at every tick, (T, 2) each [m]."""
    frames = nearest_frames(log.time, motion.rate, len(motion.com))
    planned, height = motion.com[frames], motion.com[frames, 2] - ground_heights(motion, log.time)
    velocity = np.gradient(log.com, log.period, axis=0) if log.ticks > 1 else np.zeros_like(log.com)
    return divergent_component(log.com, velocity, height), divergent_component(
        planned, motion.com_velocity[frames], height
    )


def _balance_tab(log: RunLog, motion: Motion) -> Tab:
    sides = support_extents(log, motion)
    frames = log.rows_at(FRAME_RATE)
    zmps = np.stack([log.zmp_measured, log.zmp_control, log.zmp_planned], axis=2)
    names, ends = ("measured", "controller", "planned"), ("support, least", "support, greatest")
    in_support = (
        Plot(
            f"ZMP {name} in the planned support [mm]",
            ("balance", name),
            (
                Curves("support", log.time[frames], MM_PER_M * sides[frames, :, axis], ends, ("limit",) * 2),
                Curves("zmp", log.time, MM_PER_M * zmps[:, axis], names, names),
            ),
        )
        for axis, name in enumerate("xy")
    )
    feet = motion.robot.feet
    load = Curves("load", log.time, log.foot_wrench[:, :, 2], feet)
    modes = {foot: log.foot_mode[:, k] for k, foot in enumerate(feet)}
    shades = [COLORS[name] for name in FOOT_MODE_NAMES]
    contacts = States("Planned contacts", ("contacts",), log.time, modes, FOOT_MODE_NAMES, shades)
    return Tab("Balance", (*in_support, Plot("Normal force on each foot [N]", ("balance", "force"), (load,)), contacts))


def _center_of_mass_tab(log: RunLog, motion: Motion) -> Tab:
    planned = motion.com[nearest_frames(log.time, motion.rate, len(motion.com))]
    measured_dcm, planned_dcm = measured_and_planned_dcm(log, motion)
    error = Curves("com_error", log.time, MM_PER_M * (log.com - planned), ("x", "y", "z"))
    dcm_error = Curves("dcm_error", log.time, MM_PER_M * (measured_dcm - planned_dcm), ("x", "y"))
    both = np.stack([log.com[:, :2], planned[:, :2], measured_dcm, planned_dcm], axis=2)
    names = ("CoM, measured", "CoM, planned", "DCM, measured", "DCM, planned")
    shades = ("com", "com_planned", "dcm", "dcm_planned")
    frames = log.rows_at(FRAME_RATE)
    ways = (
        Plot(
            f"Centre of mass and its divergent component, {name} [mm]",
            ("com", name),
            (Curves("way", log.time[frames], MM_PER_M * both[frames, axis], names, shades),),
        )
        for axis, name in enumerate("xy")
    )
    return Tab(
        "Centre of mass",
        (
            Plot("Centre of mass minus reference [mm]", ("com", "position"), (error,)),
            Plot("Divergent component minus reference [mm]", ("com", "divergent"), (dcm_error,)),
            *ways,
        ),
    )


def _estimate_tabs(log: RunLog) -> list[Tab]:
    """Simulated base beside the estimated one; no tab where nothing was estimated."""
    if not log.base_estimate.shape[1]:
        return []
    velocities = world_velocity(log.q, log.v), world_velocity(log.base_estimate, log.base_velocity_estimate)
    names, shades = [f"{axis}, {what}" for axis in "xyz" for what in ("true", "estimated")], SERIES_COLORS[:6]
    both = {
        "position": ("Base [mm]", MM_PER_M * np.stack([log.q[:, :3], log.base_estimate[:, :3]], axis=2)),
        "velocity": ("Velocity of the base, world axes [mm/s]", MM_PER_M * np.stack(velocities, axis=2)),
    }
    pairs = (
        Plot(title, ("estimate", kind), (Curves(kind, log.time, values.reshape(len(values), 6), names, shades),))
        for kind, (title, values) in both.items()
    )
    turn = Curves("turn", log.time, np.rad2deg(rotation_errors(log)), ("about x", "about y", "heading"))
    return [
        Tab("Estimate", (*pairs, Plot("Estimated attitude minus true one [deg]", ("estimate", "attitude"), (turn,))))
    ]


def servo_tabs(log: RunLog, robot: Robot) -> list[Tab]:
    """A tab of what servos and soles did; no tab for torque motors on rigid soles."""
    plots = []
    if log.target.shape[1]:
        off = np.rad2deg(np.abs(log.q[:, 7:] - log.target))
        errors = np.column_stack([off[:, list(robot.groups[group])].max(axis=1, initial=0.0) for group in GROUPS])
        curves = Curves("servo_error", log.time, errors, GROUPS)
        plots.append(Plot("Greatest angle off its servo's target [deg]", ("servo", "error"), (curves,)))
    if log.sole_deflection.shape[1]:
        names = [f"{foot}, {axis}" for foot in robot.feet for axis in ("roll", "pitch")]
        turns = np.rad2deg(log.sole_deflection[:, :, :2]).reshape(log.ticks, -1)
        plots.append(Plot("Turn of the soles [deg]", ("servo", "turn"), (Curves("turn", log.time, turns, names),)))
        sink = Curves("sink", log.time, MM_PER_M * log.sole_deflection[:, :, 2], robot.feet)
        plots.append(Plot("Height of the soles under the feet [mm]", ("servo", "height"), (sink,)))
    return [Tab("Servos", tuple(plots))] if plots else []


def _speed_tab(plan: Performance) -> Tab:
    share = 100.0 / (PLAN_RATE * np.diff(plan.clock))
    curve = Curves("share", plan.clock[:-1], share, ("speed",))
    return Tab("Time", (Plot("Speed of the clip, over the dancer's [%]", ("time", "speed"), (curve,)),))


def _joints_tab(log: RunLog, motion: Motion, limb: str) -> Tab:
    robot, frames = motion.robot, log.rows_at(FRAME_RATE)
    joints = [joint for group in LIMB_GROUPS[limb] for joint in robot.groups[group]]
    names = [robot.joints[joint] for joint in joints]
    angle = log.q[:, 7:][:, joints]
    error = angle - motion.q[nearest_frames(log.time, motion.rate, len(motion.q)), 7:][:, joints]
    lower, upper = robot.lower[joints], robot.upper[joints]
    share = 100.0 * (angle[frames] - lower) / (upper - lower)
    efforts = np.unique(robot.effort[joints])
    limits = np.concatenate([efforts, -efforts])
    named, red = [f"limit {limit:+g}" for limit in limits], ("limit",) * len(limits)
    greatest = 1.05 * float(efforts[-1])

    def plot(title: str, kind: str, *curves: Curves, span: tuple[float, float] | None = None) -> Plot:
        return Plot(title, ("joints", limb, kind), curves, span)

    return Tab(
        limb.replace("_", " ").capitalize(),
        (
            plot("Angle [deg]", "angle", Curves("joints", log.time, np.rad2deg(angle), names)),
            plot(
                "Angle within its range, from 0 to 100 [%]",
                "range",
                Curves("joints", log.time[frames], share, names),
                span=(0.0, 100.0),
            ),
            plot("Angle minus reference [deg]", "error", Curves("joints", log.time, np.rad2deg(error), names)),
            plot(
                "Torque [N m]",
                "torque",
                Curves("joints", log.time, log.torque[:, joints], names),
                Curves("limits", log.time[[0, -1]], np.tile(limits, (2, 1)), named, red),
                span=(-greatest, greatest),
            ),
        ),
    )


def _tasks_tab(log: RunLog) -> Tab:
    errors = (
        Plot(
            f"{level}: error [{unit}]", ("tasks", level), (Curves("error", log.time, log.level_error[:, k], (level,)),)
        )
        for k, (level, unit) in enumerate(zip(log.level_names, log.level_units, strict=True))
    )
    return Tab("Tasks", tuple(errors))


def task_level_tabs(log: RunLog) -> list[Tab]:
    """A tab that shows the level of each task that is added, removed or moved; no tab if there is no such task."""
    if not (log.level_share < 1.0).any():
        return []
    states = [f"level {place}" for place in range(log.level_place.max() + 1)]
    states[0] = "none"
    underway = (log.level_share < 1.0) & (log.level_place > 0)
    values = np.where(underway, len(states), log.level_place)  # a state of its own, after all the levels
    changing = np.flatnonzero((log.level_share < 1.0).any(axis=0))
    lanes = {log.level_names[k]: values[:, k] for k in changing.tolist()}
    shades = [
        COLORS["off"],
        *(SERIES_COLORS[place % len(SERIES_COLORS)] for place in range(1, len(states))),
        COLORS["sliding"],
    ]
    names = (*states, "on its way")
    return [Tab("Schedule", (States("Tasks and their levels", ("schedule",), log.time, lanes, names, shades),))]


def _ticks_and_solver_tab(log: RunLog) -> Tab:
    parts = np.column_stack([log.tick_us, log.model_us, log.assemble_us, log.solve_us])

    def plot(title: str, kind: str, values: np.ndarray, names: Sequence[str]) -> Plot:
        return Plot(title, ("tick", kind), (Curves(kind, log.time, values, names),))

    levels = (
        plot("Slack of each level", "slack", log.level_slack, log.level_names),
        plot("Active inequality rows of each level", "active", log.level_active, log.level_names),
    )
    return Tab(
        "Ticks",
        (
            plot("Time of a tick [µs]", "time", parts, ("tick", "model", "assemble", "solve")),
            *(levels if log.level_names else ()),
            plot("Status: 0 solved, 1 second solver, 2 relaxed, 3 failed", "status", log.status, ("status",)),
            plot("Residual of what had to hold", "residual", log.residual, ("residual",)),
        ),
    )
