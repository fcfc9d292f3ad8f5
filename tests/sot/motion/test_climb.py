"""A climb over treads: where the feet are led, that they clear every edge, and that the plan is one of balance."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion.climb import climb
from sot.motion.feet.contacts import support_polygon
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface

RISE, DEPTH, START = 0.1, 0.3, 0.16


def tread(number, level, depth=DEPTH, start=START, slope=0.0):
    sides = [depth / np.cos(slope), 1.0, 1.0]
    corners = np.array([[-0.5, -0.6, 0.0], [0.5, -0.6, 0.0], [0.5, 0.6, 0.0], [-0.5, 0.6, 0.0]]) * sides
    place = pin.SE3(pin.utils.rotate("y", -slope), np.array([start + (number + 0.5) * depth, 0.0, level * RISE]))
    return Surface(f"tread {number + 1}", corners, place)


SLOPE = np.arctan(0.4 * RISE / DEPTH)
COURSES = {
    "stairs": [tread(0, 1), tread(1, 2), tread(2, 1)],
    "ramp": [tread(0, 0.2, slope=SLOPE), tread(1, 0.4), tread(2, 0.2, slope=-SLOPE)],
}


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module", params=list(COURSES))
def treads(request):
    return COURSES[request.param]


@pytest.fixture(scope="module")
def climbed(robot, treads):
    return climb(robot, [*treads, FLOOR], 100.0)


def soles(motion, foot, t):
    pose = motion.pose(foot)(t)
    return motion.robot.sole(foot) @ pose.rotation.T + pose.position


def test_soles_stand_wholly_on_the_surface_that_the_phase_names(climbed, treads):
    seen = set()
    for phase in climbed.phases:
        for foot, place in phase.feet.items():
            surface = phase.surfaces[foot]
            corners = np.array([place.act(corner) for corner in climbed.robot.sole(foot)])
            if surface is not FLOOR:
                edges = surface.corners_at_point
                assert (corners[:, :2] > edges.min(axis=0)[:2]).all() and (corners[:, :2] < edges.max(axis=0)[:2]).all()
                np.testing.assert_allclose(corners[:, 2], surface.height_at(corners[:, :2]), atol=1e-9)
                seen.add((foot, surface.name))
    assert len(seen) == 2 * len(treads)
    assert all(place.translation[2] == pytest.approx(0.0) for place in climbed.phases[-1].feet.values())


def test_no_sole_passes_through_a_tread(climbed, treads):
    """Corners and points between them, over all of the motion; a fitted path may be half a millimetre off."""
    for foot in climbed.robot.feet:
        for t in np.arange(0.0, climbed.duration, 0.02):
            corners = soles(climbed, foot, t)
            points = np.vstack([corners, *(np.linspace(a, b, 9) for a in corners for b in corners)])
            for one in treads:
                edges = one.corners_at_point
                inside = (points[:, 0] > edges[:, 0].min() + 1e-3) & (points[:, 0] < edges[:, 0].max() - 1e-3)
                assert (points[inside, 2] > one.height_at(points[inside, :2]) - 1e-3).all(), (foot, t, one.name)


def test_the_zero_moment_point_stays_in_the_soles(climbed):
    for phase in climbed.phases:
        polygon = support_polygon(climbed.robot, phase)
        times = np.arange(phase.start + 0.05, phase.end - 0.05, 0.05)
        assert min(polygon.margin(climbed.sample(t).zmp) for t in times) > 0.01


def test_joints_stay_in_their_ranges_and_the_waist_upright(climbed):
    robot, q = climbed.robot, climbed.q[:, 7:]
    assert (q > robot.lower - 2e-3).all() and (q < robot.upper + 2e-3).all()
    waist = climbed.pose("waist")
    assert max(np.linalg.norm(pin.log3(waist(t).rotation)) for t in np.arange(0.0, climbed.duration, 0.5)) < 0.02


@pytest.mark.parametrize(
    ("treads", "expected"),
    [
        ([], "needs one tread"),
        ([tread(0, 1, depth=0.2)], "too small for the soles"),
        ([tread(0, 6)], "legs do not reach"),
        ([tread(0, 1, start=0.9)], "legs do not reach"),
        ([tread(0, 0, slope=0.4)], "it slopes by 23°, and soles hold on 17° at its friction of 0.5"),
        ([replace(tread(0, 1), point="lid")], "it moves"),
    ],
)
def test_what_cannot_be_climbed_is_told(robot, treads, expected):
    with pytest.raises(InputError, match=expected):
        climb(robot, treads, 100.0)
