"""Distances between parts of the robot: those of the physics, none missed, and their Jacobian."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim.world import World
from sot.control.tick import Tick
from sot.proximity import Proximity, overlap_remarks
from sot.robots.pairs import LIMBS
from sot.robots.robot import Robot, shipped_robot_names
from tests.sot.states import random_state

STEP = 1e-5


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def distances(proximity, tick, q):
    tick.update(0.0, q, np.zeros(len(tick.v)))
    proximity.move_to(tick.data)
    return proximity.measure(np.arange(len(proximity.pairs)))


def test_distances_are_those_of_the_physics(robot):
    world, proximity, tick, rng = World(robot), Proximity(robot), Tick(robot), np.random.default_rng(0)
    geoms = [tuple(world.model.geom(name).id for name in pair) for pair in proximity.pairs]
    for _ in range(20):
        q, _ = random_state(robot, rng)
        world.reset(q)
        expected = [mujoco.mj_geomDistance(world.model, world.data, a, b, 10.0, None) for a, b in geoms]
        np.testing.assert_allclose(distances(proximity, tick, q), expected, atol=1e-4)


def test_limbs_are_paired_with_all_else_but_their_neighbours(robot):
    pairs = Proximity(robot).pairs
    parts = {2 + joint: limb for limb in LIMBS for joint in robot.groups[limb]}
    owner = {shape.name: parts.get(shape.parentJoint, "trunk") for shape in robot.shapes.geometryObjects}
    assert all(owner[a] != owner[b] for a, b in pairs)
    met = {frozenset((owner[a], owner[b])) for a, b in pairs}
    assert met >= {frozenset(("left_arm", other)) for other in ("right_arm", "left_leg", "right_leg", "trunk")}
    assert frozenset(("left_leg", "right_leg")) in met


def test_no_pair_that_is_near_is_missed(robot):
    """Along a motion that speeds up and turns, most pairs are not looked at; whatever is near still is found."""
    proximity, tick, rng = Proximity(robot), Tick(robot), np.random.default_rng(1)
    q, _ = random_state(robot, rng)
    found = 0
    for _ in range(20):
        v = rng.uniform(-3.0, 3.0, robot.nv)
        for _ in range(25):
            q = pin.integrate(robot.model, q, 0.004 * v)
            tick.update(0.0, q, v)
            within = np.full(len(proximity.pairs), rng.uniform(0.0, 0.2))
            proximity.move_to(tick.data)
            near = proximity.pairs_within(within)
            everything = proximity.measure(np.arange(len(proximity.pairs)))
            assert near.tolist() == np.flatnonzero(everything < within).tolist()
            found += len(near)
    assert found > 100


def test_no_distance_changes_faster_than_the_joints_can_make_it(robot):
    proximity, tick, rng = Proximity(robot), Tick(robot), np.random.default_rng(2)
    for _ in range(50):
        q, v = random_state(robot, rng)
        after, before = (distances(proximity, tick, pin.integrate(robot.model, q, sign * STEP * v)) for sign in (1, 0))
        assert (np.abs(after - before) / STEP <= proximity.rate_bounds(v) + 1e-4).all()


def test_jacobian_against_finite_differences(robot):
    proximity, tick, rng = Proximity(robot), Tick(robot), np.random.default_rng(3)
    compared = 0
    for _ in range(30):
        q, v = random_state(robot, rng)
        proximity.move_to(tick.update(0.0, q, v).data)
        every = np.arange(len(proximity.pairs))
        apart, (J, rates) = proximity.measure(every), proximity.jacobian_and_rates(every, v)
        np.testing.assert_allclose(rates, J @ v, atol=1e-12)
        after, before = (distances(proximity, tick, pin.integrate(robot.model, q, sign * STEP * v)) for sign in (1, -1))
        # Overlapping shapes have no one nearest point: there the solver of distances is coarse.
        apart_enough = apart > 1e-3
        np.testing.assert_allclose((J @ v)[apart_enough], ((after - before) / (2 * STEP))[apart_enough], atol=1e-3)
        assert (J[:, :6] == 0.0).all()
        compared += np.count_nonzero(apart_enough)
    assert compared > 1000


def test_a_motion_whose_shapes_overlap_is_told(robot):
    times = np.arange(0.0, 2.0, 0.005)
    q = np.tile(robot.rest, (len(times), 1))
    assert overlap_remarks(robot, times, q) == []
    elbow, shoulder = (7 + robot.joints.index(name) for name in ("RARM3", "RARM2"))
    q[200:, elbow], q[200:, shoulder] = -2.0, 1.2  # the forearm through the chest
    (said,) = overlap_remarks(robot, times, q)
    assert "RARM5_LINK_0" in said and "CHEST" in said and "mm into each other at 1.00 s" in said
