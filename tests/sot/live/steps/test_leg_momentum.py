"""The zero-moment point's shift against the momentum that a leg really has when its foot moves."""

import numpy as np
import pinocchio as pin
import pytest

from sot.gravity import GRAVITY
from sot.live.steps.leg_momentum import zmp_shift_of_swing
from sot.robots.robot import Robot


@pytest.mark.parametrize("name", ["hrp2", "g1"])
def test_it_is_what_the_legs_momentum_changes(name):
    robot = Robot.load(name)
    shift, data = zmp_shift_of_swing(robot), robot.model.createData()
    found = []
    for foot in robot.feet:
        J = pin.computeFrameJacobian(robot.model, data, robot.rest, robot.point(foot), pin.LOCAL_WORLD_ALIGNED)
        leg = 6 + np.array(robot.groups[foot.replace("foot", "leg")])
        for way in (np.eye(6)[0], np.eye(6)[2]):
            v = np.zeros(robot.nv)
            v[leg] = np.linalg.lstsq(J[:, leg], way, rcond=None)[0]
            momentum = pin.computeCentroidalMomentum(robot.model, data, robot.rest, v).angular
            found.append(-momentum[1] / (robot.mass * GRAVITY))
    assert np.mean(found[::2]) == pytest.approx(shift.along, rel=0.2)
    assert np.mean(found[1::2]) == pytest.approx(shift.ahead, rel=0.2)
    assert shift.along > 0.0
