"""Arms that hold a box before a body that moves after a human."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.body.coordinates import from_configuration
from sot.motion.body.limits import Limits
from sot.motion.body.spline import Spline
from sot.motion.body.targets import UPPER_BODY_SEGMENTS, Targets
from sot.motion.carrying.arms import palm_places
from sot.motion.carrying.held_arms import HeldArms, HeldBox, held_places, with_box_held
from sot.robots.robot import Robot

COUNT, PERIOD, STEP = 60, 0.02, 1e-6
WIDTH = 0.34


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def wanted() -> Targets:
    down = {segment: np.tile([0.0, 0.0, -1.0], (COUNT, 1)) for segment in UPPER_BODY_SEGMENTS}
    return Targets(np.zeros((COUNT, 3)), {}, down, np.zeros(COUNT), {})


def _box(robot: Robot) -> HeldBox:
    """A box that goes 8 cm to the left before a robot at rest."""
    waist = robot.rest[:3]
    way = waist + np.array([0.36, 0.0, 0.15]) + np.outer(np.linspace(0.0, 0.08, COUNT), [0.0, 1.0, 0.0])
    return HeldBox(way, np.linspace(0.0, 0.2, COUNT), palm_places(robot, WIDTH, 0.3), np.zeros(COUNT), np.ones(COUNT))


def test_its_jacobian_is_that_of_finite_differences(robot: Robot, wanted: Targets) -> None:
    box = replace(_box(robot), gap=np.full(COUNT, 0.03), share=np.full(COUNT, 0.6))
    y = np.tile(from_configuration(robot.rest[None]), (2, 1))
    y[:, 6:] += np.random.default_rng(0).uniform(-0.2, 0.2, (2, robot.na))
    part, knots = HeldArms(robot, wanted, np.tile(y[:1], (COUNT, 1)), box), np.array([5, 40])
    _, J = part.evaluate(knots, y)
    for k, column in enumerate(part.columns):
        moved = [y.copy(), y.copy()]
        moved[0][:, column] += STEP
        moved[1][:, column] -= STEP
        ahead, behind = (part.evaluate(knots, one)[0] for one in moved)
        np.testing.assert_allclose(J[:, :, k], (ahead - behind) / (2.0 * STEP), atol=1e-3, rtol=1e-5)


def test_palms_lie_flat_on_a_box_that_is_near_its_way(robot: Robot, wanted: Targets) -> None:
    box, still = _box(robot), np.tile(from_configuration(robot.rest[None]), (COUNT, 1))
    held = with_box_held(robot, wanted, Limits.of(robot), Spline.through(still, PERIOD), box)
    y, last = held.knots, COUNT - 1
    places = held_places(robot, y, box.hands)
    assert np.linalg.norm(places[last].translation - box.way[last]) < 0.03
    assert np.arctan2(*places[last].rotation[1::-1, 0]) == pytest.approx(box.turn[last], abs=0.01)
    q, data = robot.rest.copy(), robot.model.createData()
    q[7:] = y[last, 6:]
    pin.framesForwardKinematics(robot.model, data, q)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        own = robot.surface(f"{side}_palm")
        assert own.point is not None
        palm = places[last].inverse() * data.oMf[robot.point(own.point)] * own.placement
        np.testing.assert_allclose(palm.translation, [0.0, sign * 0.5 * WIDTH, 0.0], atol=2e-3)
        np.testing.assert_allclose(palm.rotation[:, 2], [0.0, -sign, 0.0], atol=5e-3)


def test_arms_are_the_humans_where_nothing_is_held(robot: Robot, wanted: Targets) -> None:
    box = replace(_box(robot), share=np.zeros(COUNT))
    still = np.tile(from_configuration(robot.rest[None]), (COUNT, 1))
    y = with_box_held(robot, wanted, Limits.of(robot), Spline.through(still, PERIOD), box).knots
    q, data = robot.rest.copy(), robot.model.createData()
    q[7:] = y[-1, 6:]
    pin.framesForwardKinematics(robot.model, data, q)
    arm = data.oMf[robot.point("left_elbow")].translation - data.oMf[robot.point("left_shoulder")].translation
    assert arm[2] / np.linalg.norm(arm) < -0.97
