"""The figures of a run: how well the robot tracked, balanced, stood and kept its limits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sim.hardware.sole_frames import sole_frames
from sim.log import FOOT_FIXED, FOOT_OFF, FOOT_ROLLING, RunInfo, RunLog, constant_stretches, nearest_frames
from sim.support import planned_support
from solvers.rows import Status
from sot.motion.feet.contacts import Phase, phase_indices
from sot.motion.feet.path import path_length
from sot.motion.leg_likeness import foot_lift_ratio, knee_bend_deg
from sot.motion.likeness import (
    LEG_SEGMENTS,
    UPPER_SEGMENTS,
    hand_path_ratio,
    heading_difference_deg,
    hip_heading,
    mean_segment_angle_deg,
)
from sot.motion.performance import Performance
from sot.motion.quality import RATE_HZ, key_body_errors, motion_quality
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

Figures = dict[str, float | int | None]
Shares = dict[str, float]

POSE_RATE_HZ = 100.0  # rate at which positions of bodies are compared
ZMP_INSET_M = 0.010  # least distance of the ZMP from the support's edge that counts as inside
FOOTFALL_TOLERANCE_M = 0.15  # a footfall within this distance of its place counts as made
SETTLING_TIME_S = 0.1  # after a planned landing: the foot stands then
SWITCH_WINDOW_S = 0.06  # before and after a switch of contacts: its ramps
MOST_NAMED = 6  # joints in a sentence
SATURATION_RATIO = 0.99  # share of a torque limit from which on a joint counts as saturated
PUSH_RECOVERY_S = 3.0  # after a push: a robot that still stands then has survived it
KEY_POINTS = (
    "head",
    *(
        f"{side}_{point}"
        for side in ("left", "right")
        for point in ("foot", "knee", "hip", "hand", "elbow", "shoulder")
    ),
)
LIKENESS_KEYS = (
    *("segment_deg", "upper_segment_deg", "leg_segment_deg", "knee_bend_deg", "foot_lift_ratio", "heading_deg"),
    "hand_path_ratio",
)
HIPS = ("left_hip", "right_hip")


@dataclass(frozen=True)
class Points:
    """Operational points along a motion: name -> positions (T, 3) [m] and rotations (T, 3, 3), world."""

    positions: Mapping[str, np.ndarray]
    rotations: Mapping[str, np.ndarray]

    @classmethod
    def of(cls, robot: Robot, q: np.ndarray, names: tuple[str, ...] | None = None) -> "Points":
        """All points of a robot, or those named, at configurations (T, nq)."""
        data = robot.model.createData()
        names = tuple(robot.points) if names is None else names
        frames = [robot.point(name) for name in names]
        positions = np.empty((len(names), len(q), 3))
        rotations = np.empty((len(names), len(q), 3, 3))
        for row, configuration in enumerate(q):
            pin.forwardKinematics(robot.model, data, configuration)
            for index, frame in enumerate(frames):
                placement = pin.updateFramePlacement(robot.model, data, frame)
                positions[index, row], rotations[index, row] = placement.translation, placement.rotation
        return cls(dict(zip(names, positions, strict=True)), dict(zip(names, rotations, strict=True)))


def tick_us(log: RunLog) -> Figures:
    """Time of a tick and, as medians, of its parts [µs]."""
    return {
        "p50": _percentile(log.tick_us, 50),
        "p99": _percentile(log.tick_us, 99),
        "max": _percentile(log.tick_us, 100),
        "model": _percentile(log.model_us, 50),
        "assemble": _percentile(log.assemble_us, 50),
        "solve": _percentile(log.solve_us, 50),
    }


def tracking(log: RunLog, motion: Motion) -> Figures:
    """The simulated robot against its reference."""
    every = nearest_frames(log.time, motion.rate, len(motion.q))
    rows = log.rows_at(POSE_RATE_HZ)
    names = ("waist", *KEY_POINTS)
    real = Points.of(motion.robot, log.q[rows], names)
    wanted = Points.of(motion.robot, motion.q[every[rows]], names)
    off = {name: real.positions[name] - wanted.positions[name] for name in names}
    key = [np.linalg.norm(off[name] - off["waist"], axis=1) for name in KEY_POINTS]
    turn = np.einsum("tji,tjk->tik", wanted.rotations["head"], real.rotations["head"])
    cosine = (np.trace(turn, axis1=1, axis2=2) - 1.0) / 2.0
    sine = np.linalg.norm(turn - turn.transpose(0, 2, 1), axis=(1, 2)) / np.sqrt(8.0)
    return {
        "mpjpe_mm": _mean(1e3 * np.array(key)),
        "joint_rms_rad": _rms(log.q[:, 7:] - motion.q[every, 7:]),
        "com_rms_m": _rms(np.linalg.norm(log.com - motion.com[every], axis=1)),
        "hand_rms_m": _rms(np.linalg.norm([off[hand] for hand in motion.robot.hands], axis=2)),
        "head_rms_rad": _rms(np.arctan2(sine, cosine)),
    }


def quality(log: RunLog, motion: Motion) -> Figures:
    """The simulated motion by the figures that others publish: see `sot.motion.quality`."""
    rows = log.rows_at(RATE_HZ)
    figures: Figures = dict(motion_quality(motion.robot, log.q[rows], RATE_HZ)) | {"mpkpe_mm": None, "r_mpkpe_mm": None}
    if len(rows):
        wanted = motion.q[nearest_frames(log.time[rows], motion.rate, len(motion.q))]
        world, relative = key_body_errors(motion.robot, wanted, log.q[rows])
        figures |= {"mpkpe_mm": 1e3 * world, "r_mpkpe_mm": 1e3 * relative}
    return figures


def likeness(log: RunLog, plan: Performance | None) -> Figures:
    """The simulated robot against the human, while the clip plays."""
    nothing: Figures = dict.fromkeys(LIKENESS_KEYS)
    if plan is None or not log.ticks:
        return nothing
    human, motion = plan.human, plan.motion
    end = min(plan.end, float(log.time[-1]))
    shown = np.flatnonzero((human.times >= plan.start) & (human.times <= end))
    if len(shown) < 2:
        return nothing
    rows = nearest_frames(human.times[shown], 1.0 / log.period, log.ticks)
    robot = Points.of(motion.robot, log.q[rows]).positions
    person = {name: positions[shown] for name, positions in human.points.items()}
    faced = plan.clock <= end
    hips = Points.of(motion.robot, log.q[nearest_frames(plan.clock[faced], 1.0 / log.period, log.ticks)], HIPS)
    return {
        "segment_deg": mean_segment_angle_deg(person, robot),
        "upper_segment_deg": mean_segment_angle_deg(person, robot, UPPER_SEGMENTS),
        "leg_segment_deg": mean_segment_angle_deg(person, robot, LEG_SEGMENTS),
        "knee_bend_deg": knee_bend_deg(person, robot),
        "foot_lift_ratio": foot_lift_ratio(person, robot, human.rate),
        "heading_deg": heading_difference_deg(plan.heading[faced], hip_heading(hips.positions)),
        "hand_path_ratio": hand_path_ratio(person, robot, human.rate),
    }


def steps(log: RunLog, plan: Performance | None) -> Figures:
    """Footfalls of the dancer longer than 10 cm; how many the robot made, within `FOOTFALL_TOLERANCE_M` of their place
    on the scaled path; and the root's path through the room, robot over human in the robot's size."""
    nothing: Figures = dict.fromkeys(("footfalls", "made", "path_ratio", "path_scale"))
    if plan is None or plan.travel is None or not log.ticks:
        return nothing
    robot, made = plan.motion.robot, 0
    for fall in plan.travel.footfalls:
        tick = 0 if fall.landed is None else round((fall.landed + SETTLING_TIME_S) / log.period)
        if fall.landed is None or tick >= log.ticks:
            continue
        ankle = fall.foot.replace("foot", "ankle")
        place = Points.of(robot, log.q[tick : tick + 1], (ankle,)).positions[ankle][0, :2]
        made += bool(np.linalg.norm(place - fall.place) <= FOOTFALL_TOLERANCE_M)
    return {
        "footfalls": len(plan.travel.footfalls),
        "made": made,
        "path_ratio": path_length(log.q[:, :2], 1.0 / log.period) / plan.travel.path if plan.travel.path else None,
        "path_scale": plan.travel.scale,
    }


def flights(plan: Performance | None) -> Figures:
    """How often the dancer has both feet off the floor, and for how long at most [s]: the robot never has."""
    if plan is None:
        return dict.fromkeys(("count", "longest_s"))
    times = [flight.end - flight.start for flight in plan.flights]
    return {"count": len(times), "longest_s": max(times, default=None)}


def zmp(log: RunLog, motion: Motion) -> Figures:
    """The measured ZMP in the support that was planned; a tick without support or load counts as outside."""
    margins = zmp_margins(log, motion)
    known = margins[np.isfinite(margins)]
    off = np.linalg.norm(log.zmp_measured - log.zmp_planned, axis=1)
    return {
        "inside": float(np.count_nonzero(known >= ZMP_INSET_M) / log.ticks) if log.ticks else None,
        "min_margin_m": float(known.min()) if len(known) else None,
        "rms_to_planned_m": _rms(off[np.isfinite(off)]),
    }


def zmp_margins(log: RunLog, motion: Motion) -> np.ndarray:
    """Distance (T,) of the measured ZMP from the planned support's edge, negative outside [m]; nan without either."""
    margins = np.full(log.ticks, np.nan)
    for rows, polygon in planned_support(log, motion):
        margins[rows] = polygon.margin(log.zmp_measured[rows])
    return margins


def contacts(log: RunLog, motion: Motion) -> Figures:
    """Switches of contact modes, the largest change of a torque from one tick to the next around them [N m], and how
    far feet that should stand slipped, or were tilted from what they stood on."""
    robot, phases = motion.robot, phase_indices(motion.phases, log.time)
    positions, rotations = sole_frames(robot, log.q, log.sole_deflection)
    slips, tilts = [0.0], [0.0]
    for index, foot in enumerate(robot.feet):
        mode, position = log.foot_mode[:, index], positions[index]
        for state, rows in constant_stretches(mode):
            if state == FOOT_FIXED:
                slips.append(float(np.linalg.norm(position[rows, :2] - position[rows.start, :2], axis=1).max()))
        flat = (mode != FOOT_OFF) & (mode != FOOT_ROLLING)
        upward, normals = rotations[index][flat][:, :, 2], _normals_under(foot, motion.phases)[:, phases[flat]]
        across, along = np.linalg.norm(np.cross(normals, upward), axis=2), np.sum(normals * upward, axis=2)
        tilts.extend(np.arctan2(across, along).min(axis=0).tolist())
    switches = np.diff(log.foot_mode, axis=0) != 0
    steps, around = np.abs(np.diff(log.torque, axis=0)), round(SWITCH_WINDOW_S / log.period) if log.ticks > 1 else 0
    return {
        "switches": int(np.count_nonzero(switches)),
        "torque_step_max_nm": max(
            (
                float(steps[max(tick - around, 0) : tick + around + 1].max())
                for tick in np.flatnonzero(switches.any(axis=1))
            ),
            default=None,
        ),
        "slip_max_m": max(slips),
        "sole_tilt_max_deg": float(np.rad2deg(max(tilts))),
    }


def _normals_under(foot: str, phases: Sequence[Phase]) -> np.ndarray:
    """Normals (2, P, 3) of what a foot stands on in each phase, or has left and comes to where it is in the air."""
    found = np.empty((2, len(phases), 3))
    for side, numbers in enumerate((range(len(phases)), reversed(range(len(phases))))):
        normal = np.array([0.0, 0.0, 1.0])
        for number in numbers:
            if foot in phases[number].feet:
                normal = phases[number].feet[foot].rotation[:, 2]
            found[side, number] = normal
    return found


def limits(log: RunLog, robot: Robot) -> Figures:
    """Largest amount beyond each kind of limit, 0 when none; velocity and torque relative to it."""
    angle, speed, torque = log.q[:, 7:], np.abs(log.v[:, 6:]), np.abs(log.torque)
    distance = log.self_distance[np.isfinite(log.self_distance)]
    return {
        "position_max_excess_rad": _greatest_excess(np.maximum(angle - robot.upper, robot.lower - angle)),
        "velocity_max_excess": _greatest_excess(speed / robot.velocity - 1.0),
        "torque_max_excess": _greatest_excess(torque / robot.effort - 1.0),
        "self_collision_min_m": float(distance.min()) if len(distance) else None,
    }


def saturated_joints(log: RunLog, robot: Robot) -> Shares:
    """The share of ticks with its torque at its limit of each joint which ever had that, the greatest first."""
    near = _torques_at_limit(log, robot)
    shares = near.mean(axis=0) if len(near) else np.zeros(robot.na)
    return {robot.joints[k]: float(shares[k]) for k in np.argsort(-shares, kind="stable") if shares[k] > 0.0}


def saturation_remark(joints: Shares) -> list[str]:
    """The sentence that names the joints whose torque was at its limit, if there are any."""
    if not joints:
        return []
    named = [f"{joint} in {100.0 * share:.2g} % of the ticks" for joint, share in list(joints.items())[:MOST_NAMED]]
    more = f" and {len(joints) - MOST_NAMED} more" if len(joints) > MOST_NAMED else ""
    return [f"Torques at their limit: {', '.join(named)}{more}."]


def solver(log: RunLog) -> Figures:
    """Ticks whose hard level had to give way or found no answer, ticks that another answer than the solver's own
    served (the second solver's, that of the levels above, or a held torque), and the largest residual of what had to
    hold."""
    return {
        "infeasible_ticks": int(np.count_nonzero(np.isin(log.hard_status, (Status.RELAXED, Status.FAILED)))),
        "fallback_ticks": int(np.count_nonzero((log.status == Status.SECOND_SOLVER) | (log.status == Status.FAILED))),
        "invalid_ticks": len(log.invalid),
        "max_residual": _percentile(log.residual, 100),
    }


def pushes(info: RunInfo, duration: float) -> Figures:
    """How many pushes a run of this duration [s] met, and survived; the strongest impulse survived [N s].

    A push counts as survived if the robot does not fall while it acts or within `PUSH_RECOVERY_S` of its end.
    """
    given = [push for push in info.pushes if push.t < duration]
    fell = np.inf if info.fell_at_s is None else info.fell_at_s
    survived = [push.impulse for push in given if not push.t <= fell <= push.end + PUSH_RECOVERY_S]
    return {"given": len(given), "survived": len(survived), "survived_max_ns": max(survived, default=None)}


def effort(log: RunLog, robot: Robot) -> Figures:
    """Torque over time and joints [N m], fraction of ticks near a torque limit, mean absolute joint power [W]."""
    return {
        "torque_rms_nm": _rms(log.torque),
        "torque_saturated": _mean(np.any(_torques_at_limit(log, robot), axis=1, keepdims=True)),
        "power_w": _mean(np.abs(log.torque * log.v[:, 6:]).sum(axis=1)),
    }


def _torques_at_limit(log: RunLog, robot: Robot) -> np.ndarray:
    """Flags (ticks, na) of the torques that are at their limit, either way."""
    at_limit: np.ndarray = np.abs(log.torque) >= SATURATION_RATIO * robot.effort
    return at_limit


def _rms(values: np.ndarray) -> float | None:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else None


def _mean(values: np.ndarray) -> float | None:
    return float(np.mean(values)) if values.size else None


def _percentile(values: np.ndarray, share: float) -> float | None:
    return float(np.nanpercentile(values, share)) if np.isfinite(values).any() else None


def _greatest_excess(beyond: np.ndarray) -> float:
    return max(float(beyond.max(initial=0.0)), 0.0)
