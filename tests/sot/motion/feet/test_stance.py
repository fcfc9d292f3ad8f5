from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from sot.motion.body.targets import targets_of_human
from sot.motion.feet.stance import LEAD_IN_TIME, TAIL_TIME, Build, human_on_time_line, human_over_feet
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import dancer


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def build(robot):
    return Build.of(robot)


def turned(human, rotation, shift):
    return replace(
        human,
        points={name: rotation.apply(place) + shift for name, place in human.points.items()},
        frames={body: rotation.as_matrix() @ turn for body, turn in human.frames.items()},
    )


def test_build_is_that_of_the_robot(build):
    assert build.leg == pytest.approx(0.6, abs=2e-3)
    assert build.arm == pytest.approx(0.5, abs=1e-3)
    assert build.breadth == pytest.approx(0.5, abs=1e-3)
    assert np.radians(20.0) < build.turn < np.radians(30.0)


def test_place_and_heading_of_the_human_do_not_matter(build):
    human = dancer()
    here = human_over_feet(human, build)
    there = human_over_feet(turned(human, Rotation.from_euler("z", 2.5), [4.0, -3.0, 0.0]), build)
    for name, place in here.points.items():
        np.testing.assert_allclose(there.points[name], place, atol=1e-6)
    ankles = 0.5 * (here.points["left_ankle"] + here.points["right_ankle"])
    np.testing.assert_allclose(ankles, np.tile(build.ankles, (human.count, 1)), atol=1e-6)
    assert here.leg == pytest.approx(build.leg)


def test_pelvis_turns_no_further_than_the_hips(build):
    human = dancer()
    spin = Rotation.from_rotvec(np.outer(1.2 * np.sin(6.0 * human.times), [0.0, 0.0, 1.0]))
    wild = replace(
        human, frames={body: (spin * Rotation.from_matrix(r)).as_matrix() for body, r in human.frames.items()}
    )
    pelvis = human_over_feet(wild, build).frames["pelvis"]
    yaw = np.arctan2(pelvis[:, 1, 0], pelvis[:, 0, 0])
    assert np.abs(yaw).max() == pytest.approx(build.turn)


def test_time_line_holds_both_ends(build):
    human = human_on_time_line(human_over_feet(dancer(2.0), build), 50.0)
    assert human.duration == pytest.approx(LEAD_IN_TIME + 2.0 + TAIL_TIME, abs=0.03)
    waist = human.points["waist"]
    np.testing.assert_array_equal(waist[: round(50 * LEAD_IN_TIME)], np.tile(waist[0], (round(50 * LEAD_IN_TIME), 1)))
    np.testing.assert_array_equal(waist[-round(50 * TAIL_TIME) :], np.tile(waist[-1], (round(50 * TAIL_TIME), 1)))


def test_targets_lead_from_rest_to_the_human(robot, build):
    human = human_on_time_line(human_over_feet(dancer(), build), 50.0)
    wanted = targets_of_human(human, robot, build, np.zeros(human.count))
    for segment, directions in wanted.directions.items():
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
        np.testing.assert_allclose(directions[60:], human.segment_direction(segment)[60:], atol=1e-9)
    np.testing.assert_allclose(wanted.frames["pelvis"][0], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(wanted.hips[60:], human.points["waist"][60:])
    assert wanted.hips[0, 2] == pytest.approx(robot.rest[2], abs=1e-3)


def test_broad_shoulders_turn_less(robot, build):
    """The chest heads a share of the human's way: shoulders of a breadth in arm lengths sweep as far."""
    human = human_on_time_line(human_over_feet(dancer(), build), 50.0)
    chest = targets_of_human(human, robot, build, np.zeros(human.count)).frames["chest"][100]
    human_chest = human.frames["chest"][100]
    share = (0.34 / 0.5) / (build.breadth / build.arm)
    yaw, human_yaw = (np.arctan2(R[1, 0], R[0, 0]) for R in (chest, human_chest))
    assert yaw == pytest.approx(share * human_yaw, rel=1e-3)


def test_targets_begin_at_rest_over_feet_that_are_elsewhere(robot, build):
    """As the first feet are of a dancer in the middle of a spin: moved and turned; what follows is the human's."""
    human = human_on_time_line(human_over_feet(dancer(2.0), build), 50.0)
    facing = np.zeros(human.count)
    here = targets_of_human(human, robot, build, facing)
    facing[0] = 1.2
    there = targets_of_human(human, robot, build, facing, (0.3, -0.2))
    turn = pin.utils.rotate("z", 1.2)
    forearm, before = (wanted.directions["left_forearm"] for wanted in (there, here))
    np.testing.assert_allclose(there.frames["pelvis"][0], turn @ here.frames["pelvis"][0], atol=1e-9)
    np.testing.assert_allclose(forearm[0], turn @ before[0], atol=1e-9)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    middle = np.mean([data.oMf[robot.point(foot)].translation for foot in robot.feet], axis=0)
    np.testing.assert_allclose(there.hips[0], middle + turn @ (here.hips[0] - middle) + [0.3, -0.2, 0.0], atol=1e-9)
    np.testing.assert_allclose(there.hips[50:], here.hips[50:], atol=1e-9)
    np.testing.assert_allclose(forearm[50:], before[50:], atol=1e-9)
