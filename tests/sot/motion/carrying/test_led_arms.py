"""Arms whose hands are led while the body moves by a plan of its own."""

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.body.coordinates import from_configuration
from sot.motion.body.limits import Limits
from sot.motion.body.spline import Spline
from sot.motion.carrying.led_arms import LedArms, LedSurface, led_surfaces, with_hands_led
from sot.robots.robot import Robot

COUNT, PERIOD, STEP = 60, 0.02, 1e-6
AHEAD = np.array([1.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def _hands(robot: Robot, reach: float = 0.42) -> list[LedSurface]:
    """The right hand's end goes to a wall before the chest, the left palm down onto a table."""
    share = np.linspace(0.0, 1.0, COUNT)[:, None]
    right = robot.rest[:3] + [0.3, -0.2, 0.25] + share * [reach - 0.3, 0.0, 0.0]
    left = np.add(robot.rest[:3], [0.3, 0.2, 0.3]) - share * [0.0, 0.0, 0.05]
    tilt = np.full(COUNT, 0.2)
    return [
        LedSurface(robot.surface("right_hand_end"), right, np.tile(AHEAD, (COUNT, 1)), tilt),
        LedSurface(robot.surface("left_palm"), left, np.tile([0.0, 0.0, -1.0], (COUNT, 1)), tilt),
    ]


def _standing(robot: Robot) -> np.ndarray:
    return np.tile(from_configuration(robot.rest[None]), (COUNT, 1))


def test_its_jacobian_is_that_of_finite_differences(robot: Robot) -> None:
    y = _standing(robot)[:2]
    y[:, 6:] += np.random.default_rng(0).uniform(-0.2, 0.2, (2, robot.na))
    part, knots = LedArms(robot, _standing(robot), _hands(robot)), np.array([5, 40])
    _, J = part.evaluate(knots, y)
    for k, column in enumerate(part.columns):
        moved = [y.copy(), y.copy()]
        moved[0][:, column] += STEP
        moved[1][:, column] -= STEP
        ahead, behind = (part.evaluate(knots, one)[0] for one in moved)
        np.testing.assert_allclose(J[:, :, k], (ahead - behind) / (2.0 * STEP), atol=1e-3, rtol=1e-5)


def test_hands_are_where_they_are_led_and_face_where_they_should(robot: Robot) -> None:
    limits = Limits.of(robot)
    # The arms come from rest within a time of their own before they follow.
    hands = [
        LedSurface(
            one.surface,
            *(np.concatenate([np.repeat(a[:1], COUNT, axis=0), a]) for a in (one.place, one.outward, one.tilt)),
        )
        for one in _hands(robot)
    ]
    y = with_hands_led(robot, limits, Spline.through(np.tile(_standing(robot), (2, 1)), PERIOD), hands).knots
    for found, asked in zip(led_surfaces(robot, y, hands), hands, strict=True):
        np.testing.assert_allclose(found.place[-10:], asked.place[-10:], atol=5e-3)
        assert (np.sum(found.outward[-10:] * asked.outward[-10:], axis=1) > np.cos(0.15)).all()
    assert (y[:, 6:] >= limits.lower[6:] - 1e-6).all() and (y[:, 6:] <= limits.upper[6:] + 1e-6).all()
    legs = 6 + robot.joint_numbers("legs")
    np.testing.assert_allclose(y[:, legs], np.tile(_standing(robot), (2, 1))[:, legs], atol=1e-9)


def test_where_surfaces_are_is_told_as_pinocchio_has_it(robot: Robot) -> None:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    for found in led_surfaces(robot, _standing(robot)[:1], _hands(robot)):
        assert found.surface.point is not None
        at = data.oMf[robot.point(found.surface.point)] * found.surface.placement
        np.testing.assert_allclose(found.place[0], at.translation, atol=1e-9)
        np.testing.assert_allclose(found.outward[0], at.rotation[:, 2], atol=1e-9)
