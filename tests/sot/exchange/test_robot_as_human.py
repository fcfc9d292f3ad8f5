"""A robot's motion as a human's."""

import numpy as np
import pinocchio as pin
import pytest

from sot.exchange.robot_as_human import human_of_robot
from sot.exchange.robot_motion import RobotMotion
from sot.motion.feet.stance import Build
from sot.motion.human.human import SEGMENTS
from tests.sot.exchange.motions import swaying


def at_rest(x: float = 0.0, y: float = 0.0, yaw: float = 0.0, z: float = 0.0) -> RobotMotion:
    motion = swaying()
    q = np.tile(motion.robot.rest, (60, 1))
    place = pin.SE3(pin.utils.rotate("z", yaw), np.array([x, y, z]))
    q[:, :7] = pin.SE3ToXYZQUAT(place * pin.XYZQUATToSE3(q[0, :7]))
    return RobotMotion.of_configurations(motion.robot, "rest", 30.0, q)


@pytest.mark.parametrize("place", [{}, {"x": 3.0, "y": -1.0, "yaw": 2.0}, {"z": -0.02}])
def test_wherever_it_stands_it_faces_ahead_on_the_floor(place):
    human = human_of_robot(at_rest(**place))
    assert np.abs(human.points["waist"][0, :2]).max() < 1e-9
    assert abs(min(human.points[f"{side}_toe"][0, 2] for side in ("left", "right"))) < 1e-3
    for body in ("pelvis", "chest", "head"):
        assert np.abs(human.frames[body][0] - np.eye(3)).max() < 1e-6
    across = human.points["left_hip"][0] - human.points["right_hip"][0]
    assert across[1] > 0.05 and abs(across[0]) < 1e-9
    assert human.remarks == ()


def test_it_has_the_robots_size_and_all_points_of_a_human():
    motion = at_rest()
    human, build = human_of_robot(motion), Build.of(motion.robot)
    assert abs(human.leg - build.leg) < 1e-9 and abs(human.arm - build.arm) < 1e-9
    assert {name for ends in SEGMENTS.values() for name in ends} <= set(human.points)
    assert (human.rate, human.count, human.name) == (30.0, 60, "rest")


def test_its_bodies_turn_as_the_robots_do():
    motion = swaying()
    human, chest = human_of_robot(motion), motion.robot.point("chest")
    data = motion.robot.model.createData()
    turns = []
    for q in (motion.q[0], motion.q[20]):
        pin.framesForwardKinematics(motion.robot.model, data, q)
        turns.append(data.oMf[chest].rotation.copy())
    had, has = turns[0].T @ turns[1], human.frames["chest"][0].T @ human.frames["chest"][20]
    assert abs(np.trace(had) - np.trace(has)) < 1e-9  # the same angle, about the same axis in the rest's axes
