"""A made-up run whose figures are known: the robot at rest on its reference, both feet loaded alike."""

import numpy as np
import pinocchio as pin

from sim.log import FOOT_FIXED, RunLog
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.spline import Spline
from sot.motion.human.human import Human
from sot.motion.plan import Plan
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

PERIOD = 0.005
HUMAN_RATE = 50.0


def still_motion(robot: Robot, seconds: float) -> Motion:
    """The robot at rest."""
    return Motion.standing(robot, seconds, 1.0 / PERIOD)


def perfect_log(motion: Motion) -> RunLog:
    """A run that does what the motion says, to the last digit."""
    robot, count = motion.robot, len(motion.q) - 1
    log = RunLog.allocate(robot, count + 7, ("balance: com", "posture: joints"), ("m", "rad"))
    log.ticks = count
    rows = slice(0, count)
    log.time[rows] = PERIOD * np.arange(count)
    log.q[rows], log.v[rows] = motion.q[:-1], motion.v[:-1]
    log.com[rows] = motion.com[:-1]
    for column in (log.zmp_measured, log.zmp_control, log.zmp_planned):
        column[rows] = motion.zmp[:-1]
    for column in (log.torque, log.acceleration, log.foot_wrench, log.level_error, log.level_slack, log.residual):
        column[rows] = 0.0
    log.foot_wrench[rows, :, 2] = 0.5 * 9.81 * robot.mass
    log.level_place[rows], log.level_share[rows] = (1, 2), 1.0
    log.foot_mode[rows], log.foot_ramp[rows] = FOOT_FIXED, 1.0
    log.tick_us[rows] = np.linspace(100.0, 200.0, count)
    log.model_us[rows], log.assemble_us[rows], log.solve_us[rows] = 20.0, 30.0, 90.0
    return log


def same_human(motion: Motion) -> Human:
    """A human who stands as the robot does."""
    robot, data = motion.robot, motion.robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    count = round(motion.duration * HUMAN_RATE) + 1
    names = {name: data.oMf[frame].translation.copy() for name, frame in robot.points.items()}
    points = {name: np.tile(position, (count, 1)) for name, position in names.items()}
    for side in ("left", "right"):
        points.setdefault(f"{side}_toe", points[f"{side}_ankle"] + [0.15, 0.0, 0.0])
    upright = np.tile(np.eye(3), (count, 1, 1))
    return Human("made-up", HUMAN_RATE, points, {"pelvis": upright, "chest": upright, "head": upright})


def same_plan(motion: Motion) -> Plan:
    return Plan(
        motion,
        same_human(motion),
        0.0,
        motion.duration,
        motion.times,
        np.zeros(len(motion.times)),
        None,
        (),
        {"key_point_rms_m": 0.01, "frames_per_s": 600.0},
        {},
        Spline.through(from_configuration(motion.q), PERIOD),
    )
