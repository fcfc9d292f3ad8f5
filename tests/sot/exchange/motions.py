"""Motions of a robot that stands about, to be written and read."""

from functools import cache

import numpy as np
import pinocchio as pin

from sot.exchange.robot_motion import RobotMotion, velocities
from sot.robots.robot import Robot

RATE, FRAMES = 50.0, 26


@cache
def swaying(robot_name: str = "hrp2", rate: float = RATE, frames: int = FRAMES) -> RobotMotion:
    """A motion in which every joint and all six axes of the base move differently, torques and contacts with it."""
    robot = Robot.load(robot_name)
    t, k = np.arange(frames)[:, None] / rate, np.arange(robot.nv)
    way = 0.1 * np.sin(2.0 * np.pi * (0.3 + 0.02 * k) * t + k) + 0.002 * k
    q = np.array([pin.integrate(robot.model, np.array(robot.rest), step) for step in way])
    facts = {
        "source": "a test",
        "licence": "CC0 1.0",
        "command": "sot replay test",
        "revision": "abc",
        "ended": "upright",
    }
    contacts = np.column_stack([np.arange(frames) % 5 > 0, np.arange(frames) % 3 > 0])
    torque = 10.0 * way[:, 6:]
    return RobotMotion(robot, "sway", rate, q, velocities(robot, q, rate), torque, contacts, facts)
