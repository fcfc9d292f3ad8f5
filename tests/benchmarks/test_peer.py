"""What a peer is given is our robot: the model made from plain arrays moves and weighs the same."""

import numpy as np
import pinocchio as pin
import pytest

from benchmarks.peer_ticks import POINT_NAMES, robot_arrays
from benchmarks.peer_tsid import build_model
from sot.robots.robot import Robot
from tests.sot.states import random_state


@pytest.mark.parametrize("name", ["hrp2", "hrp2_modified"])
def test_the_peer_s_robot_is_ours(name):
    robot = Robot.load(name)
    q, v = random_state(robot, np.random.default_rng(5))
    arrays = robot_arrays(robot, q) | {"q": q[None], "points": np.array(POINT_NAMES)}
    model = build_model(arrays)
    for M in (pin.crba(each, each.createData(), q) for each in (model, robot.model)):
        np.testing.assert_allclose(np.triu(M), np.triu(arrays["mass_matrix"]), atol=1e-10)
    ours, theirs = robot.model.createData(), model.createData()
    pin.framesForwardKinematics(robot.model, ours, q)
    pin.framesForwardKinematics(model, theirs, q)
    for point in POINT_NAMES:
        expected = ours.oMf[robot.point(point)]
        assert theirs.oMf[model.getFrameId(point)].isApprox(expected, 1e-12)
    forces = [pin.nonLinearEffects(each, each.createData(), q, v) for each in (model, robot.model)]
    np.testing.assert_allclose(*forces, atol=1e-9)
    with pytest.raises(ValueError, match="its mass matrix differs"):
        build_model(arrays | {"masses": 1.1 * arrays["masses"]})
