"""A walk straight ahead: where it leads, and that the plan is one that a robot can do."""

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion import walk
from sot.motion.feet.contacts import support_polygon
from sot.robots.robot import Robot
from sot.robots.surface import Surface

SQUARE = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def uphill(robot):
    tilt = pin.SE3(pin.exp3(np.deg2rad(-10.0) * np.array([0.0, 1.0, 0.0])), np.zeros(3))
    return walk(robot, [0.15], 100.0, ground=Surface("hill", SQUARE, tilt))


def test_both_feet_go_as_far_and_as_high(uphill):
    first, last = uphill.phases[0].feet, uphill.phases[-1].feet
    for foot, pose in last.items():
        way = pose.translation - first[foot].translation
        np.testing.assert_allclose(way, [0.15, 0.0, 0.15 * np.tan(np.deg2rad(10.0))], atol=1e-9)


def test_steps_alternate_and_the_feet_are_where_the_phases_have_them(uphill):
    swings = [next(f for f in uphill.robot.feet if f not in p.feet) for p in uphill.phases if len(p.feet) == 1]
    assert len(swings) == 3 and swings[0] == swings[2] != swings[1]
    for phase in uphill.phases:
        pose = {foot: uphill.pose(foot)(0.5 * (phase.start + phase.end)) for foot in phase.feet}
        for foot, wanted in phase.feet.items():
            np.testing.assert_allclose(pose[foot].position, wanted.translation, atol=1e-3)
            np.testing.assert_allclose(pose[foot].rotation, wanted.rotation, atol=5e-3)


def test_the_zero_moment_point_stays_in_the_soles(uphill):
    for phase in uphill.phases:
        times = np.arange(phase.start + 0.05, phase.end - 0.05, 0.02)
        polygon = support_polygon(uphill.robot, phase)
        assert min(polygon.margin(uphill.sample(t).zmp) for t in times) > 0.0


def test_the_body_rises_with_the_ground_and_stays_upright(uphill):
    rise = uphill.com[-1] - uphill.com[0]
    assert rise[2] == pytest.approx(rise[0] * np.tan(np.deg2rad(10.0)), abs=5e-4)
    waist = uphill.pose("waist")
    assert max(np.linalg.norm(pin.log3(waist(t).rotation)) for t in np.arange(0.0, uphill.duration, 0.2)) < 0.02


def test_back_and_forth_ends_where_it_began(robot):
    motion = walk(robot, [0.05, -0.05], 100.0)
    for foot, pose in motion.phases[-1].feet.items():
        np.testing.assert_allclose(pose.translation, motion.phases[0].feet[foot].translation, atol=1e-9)


@pytest.mark.parametrize("ways", [[], [0.0], [1.0, np.nan]])
def test_no_way_is_told(robot, ways):
    with pytest.raises(InputError, match="needs one way or more"):
        walk(robot, ways)


def test_beyond_the_edge_is_told_before_anything_is_planned(robot):
    with pytest.raises(InputError, match="beyond the edge of plate"):
        walk(robot, [2.0], 100.0, Surface("plate", SQUARE))
