"""The open loop."""

import numpy as np

from sot.hardware.readings import Readings
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.planned import PlannedTargets


def test_the_plan_is_commanded_whatever_the_robot_does():
    motion = Motion.standing(Robot.load("hrp2"), 0.1, 100.0)
    na = motion.robot.na
    motion.q[:, 7:] += np.linspace(0.0, 0.1, len(motion.q))[:, None]
    again = Motion(**{name: getattr(motion, name) for name in motion.__dataclass_fields__ if name[0] != "_"})
    readings = Readings(0.0, *np.full((2, na), np.nan), *np.full((3, 3), np.nan))
    targets = PlannedTargets(again, 0.01)(0.035, np.zeros(0), np.zeros(0), readings)
    np.testing.assert_allclose(targets.position, motion.robot.rest[7:] + 0.035)
    np.testing.assert_array_equal(targets.velocity, np.zeros(na))
