"""Surfaces: axes from corners, soles as the feet have them, palms in front of the hands."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim import World
from sot.robots import Robot, Surface
from sot.robots.surface import FLOOR


def test_axes_come_of_the_corners():
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    flat = np.array([[-0.2, -0.1, 0.0], [0.2, -0.1, 0.0], [0.2, 0.1, 0.0], [-0.2, 0.1, 0.0]])
    surface = Surface.of_corners("side", flat @ turn.T + [1.0, 2.0, 3.0])
    np.testing.assert_allclose(surface.corners, flat, atol=1e-12)
    np.testing.assert_allclose(surface.placement.rotation, turn, atol=1e-12)
    np.testing.assert_allclose(surface.corners_at_point, flat @ turn.T + [1.0, 2.0, 3.0], atol=1e-12)


@pytest.mark.parametrize("name", ["hrp2", "hrp2_modified"])
def test_soles_keep_their_corners_and_face_down(name):
    robot = Robot.load(name)
    for foot in robot.feet:
        sole = robot.surface(foot)
        np.testing.assert_array_equal(sole.corners_at_point, robot.sole(foot))
        np.testing.assert_array_equal(sole.axes.rotation[:, 2], [0.0, 0.0, -1.0])


@pytest.mark.parametrize("name", ["hrp2", "hrp2_modified"])
def test_palms_face_each_other_and_touch_before_the_hand_does(name):
    world = World(Robot.load(name))
    model, data, robot = world.model, world.data, world.robot
    for side, inward in (("left", -1.0), ("right", 1.0)):
        palm = robot.surface(f"{side}_palm")
        np.testing.assert_allclose(palm.axes.rotation[:, 2], [0.0, inward, 0.0], atol=1e-12)
        for surface in (palm, robot.surface(f"{side}_hand_end")):
            site = model.site(surface.point)
            turn = data.site_xmat[site.id].reshape(3, 3)
            normal = turn @ surface.axes.rotation[:, 2]
            face = normal @ (data.site_xpos[site.id] + turn @ surface.axes.translation)
            pad = model.geom(surface.name)
            assert normal @ data.geom_xpos[pad.id] + model.geom_size[pad.id, 2] == pytest.approx(face)
            for geom in range(model.ngeom):
                if model.geom_bodyid[geom] == pad.bodyid[0] and model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CAPSULE:
                    radius, half = model.geom_size[geom, :2]
                    axis = data.geom_xmat[geom].reshape(3, 3)[:, 2]
                    assert normal @ data.geom_xpos[geom] + radius + half * abs(normal @ axis) < face - 0.01
    assert model.body_mass.sum() == pytest.approx(robot.mass)


def test_height_and_edges_of_a_patch_on_a_slope():
    tilt = pin.exp3(np.array([0.0, -0.3, 0.0]))
    square = np.array([[-1.0, -0.5, 0.0], [1.0, -0.5, 0.0], [1.0, 0.5, 0.0], [-1.0, 0.5, 0.0]])
    surface = Surface("slope", square, pin.SE3(tilt, np.array([2.0, 0.0, 0.4])))
    places = np.array([[2.0, 0.3], [2.5, -0.2]])
    np.testing.assert_allclose(surface.height_at(places), [0.4, 0.4 + 0.5 * np.tan(0.3)])
    points = np.array([[0.9, 0.0, 0.0], [0.0, -0.45, 0.0], [1.2, 0.0, 0.0]]) @ tilt.T + [2.0, 0.0, 0.4]
    np.testing.assert_allclose(surface.edge_margins(points), [0.1, 0.05, -0.2], atol=1e-12)
    assert np.isinf(FLOOR.edge_margins(points)).all() and (FLOOR.height_at(places) == 0.0).all()
