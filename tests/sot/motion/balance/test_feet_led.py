"""A motion that is led by its feet, and what a load makes of its posture."""

import numpy as np
import pinocchio as pin

from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.swing import standing_paths
from sot.robots.robot import Robot


def test_a_load_may_lower_the_body_and_pitch_the_waist() -> None:
    robot, period, count = Robot.load("hrp2"), 0.1, 13
    share = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, 5), np.ones(5)])
    arms = robot.joint_numbers("arms")
    angles, nothing = np.tile(robot.rest[7 + arms], (count, 1)), np.zeros(count)
    load = HeldLoad(arms, angles, nothing, "chest", np.zeros((count, 3)), lowered=0.08 * share, pitch=0.4 * share)
    phases = planted_phases(robot, period * (count - 1))
    motion = feet_led(robot, phases, standing_paths(phases[0], count), period, 50.0, load=load)
    first, last = motion.sample(0.0).q, motion.sample(motion.duration).q
    com = [pin.centerOfMass(robot.model, robot.model.createData(), q) for q in (first, last)]
    assert np.isclose(com[0][2] - com[1][2], 0.08, atol=1e-3)
    waists = []
    for q in (first, last):
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, q)
        waists.append(data.oMf[robot.point("waist")].rotation)
    np.testing.assert_allclose(pin.log3(waists[1] @ waists[0].T), [0.0, 0.4, 0.0], atol=1e-3)
