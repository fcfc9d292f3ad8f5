"""Arms that reach."""

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion.carrying.arms import Arms, fist_places, palm_places
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def _placed(robot: Robot, angles: np.ndarray, surface: str) -> pin.SE3:
    """Where a surface is, seen from the waist."""
    q, data = robot.rest.copy(), robot.model.createData()
    q[7 + Arms(robot).joints] = angles
    pin.framesForwardKinematics(robot.model, data, q)
    own = robot.surface(surface)
    assert own.point is not None
    place = data.oMf[robot.point(own.point)] * own.placement
    return pin.SE3(place.rotation, place.translation - data.oMf[robot.point("waist")].translation)


def test_palms_lie_flat_on_the_sides_of_a_box(robot: Robot) -> None:
    middle = np.array([0.35, 0.0, 0.15])
    angles = Arms(robot).reaching(palm_places(robot, 0.34, 0.3, middle))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        palm = _placed(robot, angles, f"{side}_palm")
        np.testing.assert_allclose(palm.translation, middle + np.array([0.0, sign * 0.17, 0.0]), atol=1e-3)
        np.testing.assert_allclose(palm.rotation[:, 2], [0.0, -sign, 0.0], atol=1e-3)


def test_fists_point_ahead(robot: Robot) -> None:
    middle = np.array([0.36, 0.0, 0.3])
    angles = Arms(robot).reaching(fist_places(robot, 0.45, middle))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        end = _placed(robot, angles, f"{side}_hand_end")
        np.testing.assert_allclose(end.translation, middle + np.array([0.0, sign * 0.225, 0.0]), atol=1e-3)
        np.testing.assert_allclose(end.rotation[:, 2], [1.0, 0.0, 0.0], atol=1e-3)


def test_what_is_out_of_reach_is_refused(robot: Robot) -> None:
    with pytest.raises(InputError, match="do not reach"):
        Arms(robot).reaching(palm_places(robot, 0.34, 0.3, np.array([1.5, 0.0, 0.2])))
