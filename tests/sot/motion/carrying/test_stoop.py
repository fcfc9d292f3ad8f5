"""A robot stoops to where its hands are to be."""

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion.carrying.arms import palm_places
from sot.motion.carrying.stoop import Stoop, StoopedArms, stooped_way
from sot.robots.robot import Robot
from sot.robots.size import leg_length

SIDES = ("left", "right")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def _frames(robot: Robot, q: np.ndarray) -> pin.Data:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data


def test_hands_feet_waist_and_centre_of_mass_are_where_they_should_be(robot: Robot) -> None:
    hands = palm_places(robot, 0.34, 0.6, np.array([0.37, 0.0, 0.55]))
    q = StoopedArms(robot).reaching(hands, Stoop(0.1, 0.6))
    data, rest = _frames(robot, q), _frames(robot, robot.rest)
    for hand, place in hands.items():
        assert np.linalg.norm(pin.log6(data.oMf[robot.point(hand)].actInv(place)).vector) < 1e-6
    for foot in robot.feet:
        moved = data.oMf[robot.point(foot)].actInv(rest.oMf[robot.point(foot)])
        assert np.linalg.norm(pin.log6(moved).vector) < 1e-6
    turn = data.oMf[robot.point("waist")].rotation @ rest.oMf[robot.point("waist")].rotation.T
    np.testing.assert_allclose(pin.log3(turn), [0.0, 0.6, 0.0], atol=1e-6)
    com = [pin.centerOfMass(robot.model, robot.model.createData(), one) for one in (robot.rest, q)]
    np.testing.assert_allclose(com[0] - com[1], [0.0, 0.0, 0.1], atol=1e-6)
    assert (q[7:] >= robot.lower - 1e-12).all() and (q[7:] <= robot.upper + 1e-12).all()


def test_a_place_out_of_reach_is_told(robot: Robot) -> None:
    far = palm_places(robot, 0.34, 0.6, np.array([1.5, 0.0, 0.5]))
    with pytest.raises(InputError, match="does not reach where its hands should be"):
        StoopedArms(robot).reaching(far, Stoop())


def test_postures_along_a_way_are_near_one_another(robot: Robot) -> None:
    heights = np.linspace(0.83, 0.6, 6)
    hands = [palm_places(robot, 0.34, 0.6, np.array([0.62 * leg_length(robot), 0.0, z])) for z in heights]
    stoops = [Stoop(0.1 * k / 5.0, 0.5 * k / 5.0) for k in range(6)]
    q = stooped_way(StoopedArms(robot), hands, stoops)
    assert np.abs(np.diff(q[:, 7:], axis=0)).max() < 0.3
