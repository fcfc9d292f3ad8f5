"""The static stability region: hulls on level ground, hand supports by levers, and what lies inside and outside."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import linprog

from sot.errors import InputError
from sot.polygon import Polygon
from sot.static_region import TOLERANCE, Patch, static_region

W = 500.0
FOOT = np.array([[-0.1, -0.05, 0.0], [0.13, -0.05, 0.0], [0.13, 0.05, 0.0], [-0.1, 0.05, 0.0]])
LEVEL = np.eye(3)


def foot(x=0.0, y=0.0, z=0.0, axes=LEVEL, friction=0.5, most=np.inf):
    return Patch(FOOT @ axes.T + [x, y, z], axes, friction, most)


def same(region, expected):
    """Each contains the corners of the other, but for the tolerance."""
    assert (expected.margin(region.vertices) > -1e-6).all()
    assert (region.margin(expected.vertices) > -2.0 * TOLERANCE).all()


def test_on_level_ground_it_is_the_hull_of_the_points():
    feet = [foot(y=0.1), foot(x=0.3, y=-0.1)]
    same(static_region(feet, W), Polygon.hull(np.vstack([patch.points[:, :2] for patch in feet])))


def test_without_friction_heights_do_not_matter():
    feet = [foot(y=0.1, friction=0.0), foot(x=0.3, y=-0.1, z=0.4, friction=0.0)]
    same(static_region(feet, W), Polygon.hull(np.vstack([patch.points[:, :2] for patch in feet])))


def test_a_hand_that_bears_so_much_moves_the_edge_by_its_lever():
    """A point of a table at x = 0.6 that bears a fifth of the weight: c = 0.8 × 0.13 + 0.2 × 0.6, without friction."""
    hand = Patch(np.array([[0.6, 0.0, 0.8]]), LEVEL, 0.0, 0.2 * W)
    region = static_region([foot(friction=0.0), hand], W)
    assert region.vertices[:, 0].max() == pytest.approx(0.8 * 0.13 + 0.2 * 0.6, abs=1e-6)
    assert region.vertices[:, 0].min() == pytest.approx(-0.1, abs=1e-6)


def test_a_hand_on_a_wall_holds_by_its_height_what_the_floor_holds_by_friction():
    """It pushes back with N at a height h, which the foot's friction has to give: c = 0.13 + N h / W, N = μ W."""
    wall = pin.rpy.rpyToMatrix(0.0, -0.5 * np.pi, 0.0)  # z points to -x
    hand = Patch(np.array([[0.5, 0.0, 1.0]]), wall, 0.0)
    region = static_region([foot(friction=0.3), hand], W)
    assert region.vertices[:, 0].max() == pytest.approx(0.13 + 0.3 * 1.0, abs=1e-6)
    assert region.vertices[:, 0].min() == pytest.approx(-0.1, abs=1e-6)


def test_steep_ground_holds_by_friction_or_not_at_all():
    steep = pin.exp3(np.array([0.0, 0.5, 0.0]))
    sole = foot(axes=steep, friction=0.7)
    same(static_region([sole], W), Polygon.hull(sole.points[:, :2]))
    with pytest.raises(InputError, match="hold the weight"):
        static_region([foot(axes=steep, friction=0.3)], W)


def test_what_is_inside_can_be_held_and_what_is_outside_cannot():
    """By a programme of its own for each place: three supports at all angles, forces bounded."""
    rng = np.random.default_rng(4)
    patches = [
        foot(y=0.1, axes=pin.exp3(np.array([0.1, -0.1, 0.3]))),
        foot(x=0.2, y=-0.15, z=0.2, axes=pin.exp3(np.array([-0.2, 0.1, 0.0]))),
        Patch(np.array([[0.6, 0.2, 0.9], [0.6, 0.3, 0.9]]), pin.exp3(np.array([0.0, -0.6, 0.0])), 0.6, 0.3 * W),
    ]
    region = static_region(patches, W)
    turns = np.pi * np.arange(8) / 4.0
    cone = np.column_stack([np.cos(turns), np.sin(turns), np.ones(8)])
    forces, arms, owner = [], [], []
    for number, patch in enumerate(patches):
        for point in patch.points:
            for edge in cone * [patch.friction, patch.friction, 1.0]:
                forces.append(patch.axes @ edge)
                arms.append(np.cross(point, patch.axes @ edge))
                owner.append(number)
    A = np.vstack([np.array(forces).T, np.array(arms).T])
    load = (np.array(owner) == 2).astype(float)[None]
    checked = [0, 0]
    for place in rng.uniform(region.vertices.min(axis=0) - 0.1, region.vertices.max(axis=0) + 0.1, (200, 2)):
        margin = float(region.margin(place))
        if abs(margin) < 2.0 * TOLERANCE:
            continue
        wanted = np.array([0.0, 0.0, W, place[1] * W, -place[0] * W, 0.0])
        held = linprog(np.zeros(A.shape[1]), load, [0.3 * W], A, wanted).status == 0
        assert held == (margin > 0.0)
        checked[held] += 1
    assert min(checked) > 20
