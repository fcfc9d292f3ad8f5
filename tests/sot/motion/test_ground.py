"""What is planned for the level floor, laid onto a plane."""

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.swing import standing_paths
from sot.motion.ground import Ground
from sot.robots.robot import Robot
from sot.robots.surface import Surface

SQUARE = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])


def plane(degrees, friction=0.5, half=1.0, axis=(0.0, 1.0, 0.0)):
    place = pin.SE3(pin.exp3(np.deg2rad(degrees) * np.array(axis)), np.array([0.1, 0.0, 0.3]))
    return Surface("plane", half * SQUARE, place, None, friction)


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def test_the_floor_changes_nothing(robot):
    phases = planted_phases(robot, 1.0)
    paths = standing_paths(phases[0], 3)
    laid = Ground().laid_paths(paths)
    for foot, pose in Ground().laid_phases(robot, phases)[0].feet.items():
        assert pose.isApprox(phases[0].feet[foot], 1e-15)
        np.testing.assert_array_equal(laid[foot].position, paths[foot].position)
        np.testing.assert_array_equal(laid[foot].rotation, paths[foot].rotation)


def test_soles_lie_flat_where_they_were_seen_from_above(robot):
    ground, flat = Ground(plane(-10.0)), planted_phases(robot, 1.0)[0].feet
    origin, normal = ground.surface.placement.translation, ground.surface.placement.rotation[:, 2]
    for foot, pose in ground.laid_phases(robot, planted_phases(robot, 1.0))[0].feet.items():
        corners = np.array([pose.act(corner) for corner in robot.sole(foot)])
        np.testing.assert_allclose((corners - origin) @ normal, 0.0, atol=1e-9)
        np.testing.assert_allclose(pose.translation[:2], flat[foot].translation[:2])


def test_paths_keep_their_height_above_the_ground(robot):
    ground, paths = Ground(plane(8.0, axis=(0.6, 0.8, 0.0))), standing_paths(planted_phases(robot, 1.0)[0], 2)
    for path in paths.values():
        path.position[1] += [0.1, 0.05, 0.04]
    for foot, path in ground.laid_paths(paths).items():
        normal = ground.surface.placement.rotation[:, 2]
        above = (path.position - ground.surface.placement.translation) @ normal
        np.testing.assert_allclose(above, paths[foot].position[:, 2], atol=1e-12)
        pose = ground.laid(pin.SE3(paths[foot].rotation[1], paths[foot].position[1]))
        np.testing.assert_allclose(pose.translation, path.position[1])
        np.testing.assert_allclose(pose.rotation, path.rotation[1])


def test_what_cannot_be_walked_on_is_told_in_one_line(robot):
    with pytest.raises(InputError, match=r"plane is too steep to walk on: 30 degrees, .* holds a sole up to 27"):
        Ground(plane(30.0))
    with pytest.raises(InputError, match=r"left_foot would stand \d+ cm beyond the edge of plane from 0.0 s on"):
        Ground(plane(5.0, half=0.1)).laid_phases(robot, planted_phases(robot, 1.0))
    with pytest.raises(InputError, match="it is part of 'box', which moves"):
        Ground(Surface("box/top", SQUARE, point="box"))
