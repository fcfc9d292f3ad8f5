"""Feet in the air go where the dancer's legs lead them, and land where they were to land."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.motion.body.free_feet import DancersFeet, _tilt_above
from sot.motion.body.limits import Limits
from sot.motion.body.targets import targets_of_human
from sot.motion.feet.course import stepping_course, with_clock
from sot.motion.feet.stance import Build, human_on_time_line
from sot.motion.feet.swing import feet_heading
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import walker

RATE = 50.0


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def course(robot):
    return stepping_course(human_on_time_line(walker(), RATE), robot, Build.of(robot), None)


def feet_of(robot, course):
    build = Build.of(robot)
    wanted = targets_of_human(course.human, robot, build, feet_heading(course.feet))
    return DancersFeet(robot, build, Limits.of(robot), course, wanted)


@pytest.fixture(scope="module")
def dancers_feet(robot, course):
    return feet_of(robot, course)


def test_standing_feet_stay_where_they_stood_and_nothing_of_a_swing_leaves_it_as_it_was(course, dancers_feet):
    none, full = (dancers_feet.paths([share] * len(course.travel.steps)) for share in (0.0, 1.0))
    for foot, path in course.feet.items():
        stands = path.free == 0.0
        np.testing.assert_array_equal(none[foot].position, path.position)
        np.testing.assert_allclose(full[foot].position[stands], path.position[stands], atol=0.01)
        np.testing.assert_allclose(full[foot].rotation[stands], path.rotation[stands], atol=1e-9)
        assert np.abs(full[foot].position - path.position).max() > 0.02


def test_a_sole_in_the_air_is_above_the_floor(robot, course, dancers_feet):
    for foot, path in dancers_feet.paths([1.0] * len(course.travel.steps)).items():
        corners = path.position[:, None] + np.einsum("tij,cj->tci", path.rotation, robot.sole(foot))
        assert corners[:, :, 2].min() > -1e-3


def test_a_swing_goes_on_from_where_its_heel_has_risen_to(robot):
    course = stepping_course(human_on_time_line(walker(stride=0.5), RATE), robot, Build.of(robot), None)
    assert any(course.rises)
    for foot, path in feet_of(robot, course).paths([1.0] * len(course.travel.steps)).items():
        turned = Rotation.from_matrix(path.rotation[1:]) * Rotation.from_matrix(path.rotation[:-1]).inv()
        assert turned.magnitude().max() * RATE < robot.velocity.max()
        for step, rise in zip(course.travel.steps, course.rises, strict=True):
            if rise is not None and step.foot == foot:
                first = np.searchsorted(course.human.times, step.lift + 1e-9)
                moved = np.linalg.norm(np.diff(path.position[first - 2 : first + 2], axis=0), axis=1)
                assert moved.max() < 0.02


def test_a_slower_clock_moves_the_dancers_steps_as_well(robot, course):
    slow = with_clock(course, robot, 1.25 * course.human.times)
    for before, after in zip(course.travel.moves, slow.travel.moves, strict=True):
        assert (after.lift, after.land) == pytest.approx((1.25 * before.lift, 1.25 * before.land), abs=0.02)


def test_a_tilt_is_lessened_to_the_room_that_there_is():
    corners = np.array([[0.1, 0.0, -0.1], [-0.1, 0.0, -0.1]])
    tilt = np.tile([0.0, 0.5, 0.0], (40, 1))
    free = _tilt_above(np.full(40, 0.2), tilt, corners, Rotation.identity(40))
    np.testing.assert_allclose(free.as_rotvec(), tilt, atol=1e-9)
    tight = _tilt_above(np.full(40, 0.11), tilt, corners, Rotation.identity(40))
    assert (tight.as_matrix() @ corners.T)[:, 2].min() >= -0.11
    assert tight.as_rotvec()[:, 1].max() > 0.05


def test_planted_feet_have_no_swings(robot, course):
    assert feet_of(robot, replace(course, travel=None)).paths([]).keys() == course.feet.keys()
