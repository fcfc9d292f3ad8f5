from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.balance.relief import RelievedBody
from sot.motion.body.coordinates import from_configuration, to_configuration
from sot.motion.feet.contacts import Phase, planted_phases
from sot.robots.robot import Robot


class Nothing:
    """A part of the body that asks for nothing."""

    def __init__(self, robot):
        self.columns = np.arange(robot.nv)

    def evaluate(self, knots, y):
        return np.zeros((len(y), 0)), np.zeros((len(y), 0, len(self.columns)))


@pytest.fixture(scope="module")
def weak():
    """HRP-2 whose hips and knees have a tenth of their effort."""
    robot = Robot.load("hrp2")
    effort = robot.effort.copy()
    effort[list(robot.groups["legs"])] *= 0.1
    return replace(robot, effort=effort)


def alone(robot):
    return [Phase(0.0, 1.0, {"left_foot": planted_phases(robot, 1.0)[0].feet["left_foot"]})]


def test_only_a_leg_that_stands_alone_is_relieved(weak):
    y, knots = from_configuration(weak.rest[None]), np.zeros(1, dtype=int)
    assert RelievedBody(Nothing(weak), weak, alone(weak), 0.02).excess(knots, y)[0].any()
    assert not RelievedBody(Nothing(weak), weak, planted_phases(weak, 1.0), 0.02).excess(knots, y)[0].any()


def test_the_jacobian_is_that_of_the_excess_where_the_wrench_stays(weak):
    """Of motions that leave the standing foot and the centre of mass where they are, which keep the wrench."""

    rng, model, data = np.random.default_rng(1), weak.model, weak.model.createData()
    y = from_configuration(weak.rest[None])
    y[0, 3:] += 0.05 * rng.normal(size=weak.nv - 3)
    body = RelievedBody(Nothing(weak), weak, alone(weak), 0.02)
    knots = np.zeros(1, dtype=int)
    errors, jacobian = body.excess(knots, y)
    over = np.flatnonzero(errors[0])
    assert len(over) > 1

    def fixed(at):

        (q,) = to_configuration(at)
        pin.framesForwardKinematics(model, data, q)
        pose = data.oMf[weak.point("left_foot")].copy()
        return np.concatenate([pose.translation, pin.log3(pose.rotation), pin.centerOfMass(model, data, q)])

    step = 1e-6
    change = np.array([(fixed(y + step * e) - fixed(y - step * e)) / (2.0 * step) for e in np.eye(weak.nv)]).T
    _, _, V = np.linalg.svd(change)
    for way in V[9:][:5]:
        slope = (body.excess(knots, y + step * way)[0] - body.excess(knots, y - step * way)[0]) / (2.0 * step)
        np.testing.assert_allclose(slope[0, over], (jacobian[0] @ way)[over], rtol=2e-4, atol=2e-3)
