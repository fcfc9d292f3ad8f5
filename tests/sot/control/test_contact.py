"""A contact's forces against sums over its vertices, its friction against the cone, its drive against a tilted foot."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import linprog

from sot.control.contact import Contact
from sot.control.pose import Pose
from sot.control.quantities.frames import FrameState
from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot, shipped_robot_names
from sot.robots.surface import Surface
from tests.sot.states import random_state

FOOT = "left_foot"


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def standing(robot, seed):
    """A tick at rest somewhere on the floor, turned about the vertical: both soles are flat."""
    rng = np.random.default_rng(seed)
    q = robot.rest.copy()
    turn = pin.exp3(np.array([0.0, 0.0, rng.uniform(-3, 3)]))
    base = pin.SE3(turn, np.append(rng.uniform(-2, 2, 2), 0.0)) * pin.XYZQUATToSE3(q[:7])
    q[:7] = pin.SE3ToXYZQUAT(base)
    return Tick(robot).update(0.0, q, np.zeros(robot.nv))


def forces_in_cone(rng, count, friction):
    """Forces at vertices, inside their cones, shape (count, 3)."""
    normal = rng.uniform(0, 200, count)
    angle, share = rng.uniform(0, 2 * np.pi, count), rng.uniform(0, 1, count)
    tangential = (friction * share * normal)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.column_stack([tangential, normal])


def test_wrench_map_sums_the_vertex_forces_and_their_moments(robot):
    rng = np.random.default_rng(0)
    contact, tick = Contact(robot.surface(FOOT)), Tick(robot)
    for _ in range(5):
        tick.update(0.0, *random_state(robot, rng))
        R, forces = tick.frame(FOOT).rotation, rng.normal(size=contact.vertices.shape)
        moment = sum(np.cross(R @ vertex, R @ force) for vertex, force in zip(contact.vertices, forces, strict=True))
        wrench = contact.wrench_map(tick) @ forces.ravel()
        np.testing.assert_allclose(wrench, np.concatenate([R @ forces.sum(axis=0), moment]), atol=1e-12)


def test_wrench_map_gives_the_forces_power(robot):
    """Power of the vertex forces at the vertices' velocities: what makes J^T G the right map to joint torques."""
    rng = np.random.default_rng(1)
    contact, tick = Contact(robot.surface(FOOT)), Tick(robot)
    q, v = random_state(robot, rng)
    step, model, forces = 1e-6, robot.model, rng.normal(size=contact.vertices.shape)

    def vertices(q):
        frame = tick.update(0.0, q, v).frame(FOOT)
        return frame.position + contact.vertices @ frame.rotation.T

    velocities = (vertices(pin.integrate(model, q, step * v)) - vertices(pin.integrate(model, q, -step * v))) / step / 2
    tick.update(0.0, q, v)
    power = v @ tick.frame(FOOT).jacobian.T @ contact.wrench_map(tick) @ forces.ravel()
    assert power == pytest.approx(np.sum(velocities * (forces @ tick.frame(FOOT).rotation.T)), abs=1e-6)


def test_vertices_are_drawn_in_towards_the_middle(robot):
    sole = robot.sole(FOOT)
    drawn = Contact(robot.surface(FOOT), inset=0.01).vertices
    np.testing.assert_allclose(np.ptp(sole, axis=0) - np.ptp(drawn, axis=0), [0.02, 0.02, 0.0], atol=1e-12)
    np.testing.assert_allclose(drawn.mean(axis=0), sole.mean(axis=0), atol=1e-12)


@pytest.mark.parametrize("friction", [0.2, 0.7])
def test_friction_pyramids_lie_in_the_cone_and_touch_it(robot, friction):
    contact = Contact(robot.surface(FOOT), friction=friction)
    C, lower, upper = contact.force_inequalities(1000.0)
    count, slopes = len(contact.vertices), []
    for angle in np.linspace(0, 2 * np.pi, 80, endpoint=False):
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        pull = np.kron(np.eye(count)[1], along)  # at one vertex, under a normal force of one newton there
        normal = np.kron(np.eye(count)[1], [0.0, 0.0, 1.0])
        reach = C @ pull
        limit = (upper - C @ normal)[reach > 1e-9] / reach[reach > 1e-9]
        slopes.append(limit.min())
    assert max(slopes) == pytest.approx(friction)
    assert min(slopes) == pytest.approx(friction * np.cos(np.pi / 8.0))
    each = np.tile([0.0, 0.0, 10.0], count)
    assert np.all(C @ each <= upper + 1e-12) and np.all(C @ each >= lower - 1e-12)
    assert np.any(C @ -normal < lower)  # the floor does not pull


@pytest.mark.parametrize("seed", range(3))
def test_the_paper_s_form_holds_for_whatever_vertices_can_give(robot, seed):
    rng, tick = np.random.default_rng(seed), standing(robot, seed)
    vertices, reduced = Contact(robot.surface(FOOT)), Contact(robot.surface(FOOT), form="unilateral")
    E, (C, lower, upper) = reduced.force_equalities(tick), reduced.force_inequalities(1000.0)
    for _ in range(5):
        forces = forces_in_cone(rng, len(vertices.vertices), vertices.friction)
        wrench = vertices.wrench_map(tick) @ forces.ravel()
        phi = np.concatenate([wrench, forces[:, 2]])
        np.testing.assert_allclose(E @ phi, 0.0, atol=1e-9)
        np.testing.assert_allclose(reduced.wrench_map(tick) @ phi, wrench)
        assert np.all(C @ phi >= lower) and np.all(C @ phi <= upper)
        for moved in range(2, 5):  # a normal force or a tilting moment of another size has other vertex forces
            wrong = phi.copy()
            wrong[moved] += 1.0
            assert np.abs(E @ wrong).max() > 0.5
        pulling = phi.copy()
        pulling[6] = -1.0
        assert np.any(C @ pulling < lower)


def largest(contact, direction):
    C, lower, upper = contact.force_inequalities(1000.0)
    both = np.vstack([C, -C]), np.concatenate([upper, -lower])
    finite = np.isfinite(both[1])
    answer = linprog(-direction, both[0][finite], both[1][finite], bounds=(-1e5, 1e5))
    assert answer.status == 0
    return -answer.fun


@pytest.mark.parametrize("load", [0.0, 0.3, 0.99])
def test_load_limits_the_normal_force_and_with_it_the_friction(robot, load):
    contact = Contact(robot.surface(FOOT), friction=0.5)
    contact.load = load
    count = len(contact.vertices)
    assert largest(contact, np.tile([0.0, 0.0, 1.0], count)) == pytest.approx(load**3 * 2000.0, abs=1e-6)
    assert largest(contact, np.tile([1.0, 0.0, 0.0], count)) == pytest.approx(
        0.5 * np.cos(np.pi / 8) * load**3 * 2000, abs=1e-6
    )
    contact = Contact(robot.surface(FOOT), form="unilateral")
    contact.load = load
    normals = np.concatenate([np.zeros(6), np.ones(count)])
    assert largest(contact, normals) == pytest.approx(load**3 * 2000.0, abs=1e-6)


def test_a_foot_that_stands_presses_at_every_vertex_and_in_a_ramp_only_as_it_may(robot):
    contact = Contact(robot.surface(FOOT))
    presses = []
    for contact.load in np.linspace(0.0, 1.0, 11):
        C, lower, upper = contact.force_inequalities(1000.0)
        normals = C[:, 2::3].sum(axis=1) == 1.0
        least, most = lower[normals], upper[normals]
        assert len(least) == len(contact.vertices) and np.ptp(least) == 0.0
        assert np.all(least <= 0.1 * most)
        presses.append(least.sum())
    assert presses[0] == presses[5] == 0.0 and presses[10] == pytest.approx(20.0)
    assert np.diff(presses).max() < 5.0  # as gradually as the ramp


def test_full_load_is_not_limited(robot):
    for form in ("pyramid", "unilateral"):
        assert np.isinf(Contact(robot.surface(FOOT), form=form).force_inequalities(1000.0)[2]).any()


@pytest.mark.parametrize(("mode", "axes", "forces"), [("fixed", 6, True), ("sliding", 3, True), ("off", 0, False)])
def test_modes_hold_what_they_say(robot, mode, axes, forces):
    for form in ("pyramid", "unilateral"):
        contact = Contact(robot.surface(FOOT), form=form)
        contact.mode = mode
        assert len(contact.held_axes) == axes
        assert bool(contact.force_count) == forces
    assert set(contact.held_axes) <= {2, 3, 4} or mode == "fixed"


@pytest.mark.parametrize("form", ["pyramid", "unilateral"])
def test_a_sliding_foot_meets_friction_against_its_way(robot, form):
    """Each vertex on its own: the foot goes forward and turns."""
    twist = np.array([0.1, 0.02, 0.0, 0.0, 0.0, 0.5])
    path = Pose(np.zeros(3), np.eye(3), twist, np.zeros(6))
    contact = Contact(robot.surface(FOOT), form=form, path=lambda t: path, sliding_friction=0.6)
    contact.mode = "sliding"
    tick = Tick(robot)
    G, normals = contact.wrench_map(tick), np.array([3.0, 4.0, 5.0, 6.0])
    force, moment = np.zeros(3), np.zeros(3)
    for vertex, normal in zip(contact.vertices, normals, strict=True):
        arm = tick.frame(FOOT).rotation @ vertex
        speed = twist[:3] + np.cross(twist[3:], arm)
        at = normal * np.array([0.0, 0.0, 1.0]) - 0.6 * normal * speed / np.linalg.norm(speed)
        force, moment = force + at, moment + np.cross(arm, at)
    np.testing.assert_allclose(G @ normals, np.concatenate([force, moment]), atol=1e-9)
    assert twist[:3] @ (G @ normals)[:3] < 0.0
    assert contact.force_equalities(tick).shape == (0, 4)


def test_a_sliding_load_is_light_and_bounded_and_friction_fades_at_rest(robot):
    contact = Contact(robot.surface(FOOT))
    contact.mode = "sliding"
    C, lower, upper = contact.force_inequalities(1000.0)
    np.testing.assert_array_equal(C, np.eye(4))
    assert 20.0 < lower.sum() < upper.sum() < 150.0
    np.testing.assert_allclose(contact.wrench_map(Tick(robot))[:2], 0.0, atol=1e-12)


def test_the_drive_lays_a_tilted_foot_flat_and_at_rest(robot):
    contact = Contact(robot.surface(FOOT))
    rotation = pin.exp3(np.array([0.0, 0.0, 0.8])) @ pin.exp3(np.array([0.06, -0.09, 0.0]))
    position, velocity = np.array([0.3, -0.2, 0.01]), np.array([0.1, -0.1, 0.05, 0.3, 0.2, -0.1])
    heading, tilts, step = rotation[:, 0].copy(), [], 0.001
    for _ in range(2000):
        frame = FrameState(position, rotation, velocity, np.zeros((6, 0)), np.zeros(6))
        tick = SimpleNamespace(relative_frame=lambda *pair, frame=frame: frame, surface_axes=lambda of: of.placement)
        velocity = velocity + step * contact.acceleration(tick)
        position, rotation = position + step * velocity[:3], pin.exp3(step * velocity[3:]) @ rotation
        tilts.append(np.arccos(min(rotation[2, 2], 1.0)))
    assert tilts[0] > 0.1
    assert max(tilts) < 1.1 * tilts[0]
    assert tilts[-1] < 1e-3 and abs(position[2]) < 1e-4 and np.abs(velocity).max() < 1e-3
    assert rotation[:, 0] @ heading > 0.99  # it is not turned about the vertical


def test_what_a_contact_asks_for_is_led_over_from_how_its_point_arrived(robot):
    contact, tick = Contact(robot.surface(FOOT)), Tick(robot)
    tick.update(0.0, *random_state(robot, np.random.default_rng(3)))
    wanted, contact.arrival_acceleration = contact.acceleration(tick), np.arange(6.0)
    away = []
    for contact.load in np.linspace(0.0, 1.0, 11):
        away.append(np.abs(contact.acceleration(tick) - wanted).max())
    np.testing.assert_allclose(away[0], np.abs(np.arange(6.0) - wanted).max())
    assert (np.diff(away) < 0.0).all() and away[-1] == 0.0
    contact.load = 0.5  # gives its load away again
    np.testing.assert_array_equal(contact.acceleration(tick), wanted)


@pytest.mark.parametrize(("form", "mode"), [("pyramid", "fixed"), ("unilateral", "fixed"), ("pyramid", "sliding")])
def test_what_a_contact_writes_is_what_it_says(robot, form, mode):
    rng, contact, tick = np.random.default_rng(4), Contact(robot.surface(FOOT), form=form), Tick(robot)
    tick.update(0.0, *random_state(robot, rng))
    contact.mode, contact.load, contact.arrival_acceleration = mode, 0.4, rng.normal(size=6)
    at, G = contact.motion(tick), contact.wrench_map(tick)
    wanted, place = np.empty(6), np.empty(3)
    map, motion = np.empty(G.shape), np.empty((robot.nv, G.shape[1]))
    assert contact.write_rows(tick, at, wanted, place, map, motion, -3.0)
    np.testing.assert_allclose(wanted, contact.acceleration(tick) - at.drift, atol=1e-12)
    np.testing.assert_array_equal(place, at.position)
    np.testing.assert_allclose(map, G, atol=1e-15)
    np.testing.assert_allclose(motion, -3.0 * at.jacobian.T @ G, atol=1e-12)


def test_a_rolling_contact_bears_at_its_front_edge_and_flat_again_at_all(robot):
    contact, tick = Contact(robot.surface(FOOT)), standing(robot, 5)
    vertices, pose = contact.vertices, tick.frame(FOOT)
    axes = contact.motion(tick).rotation
    still = Pose(pose.position, axes, np.zeros(6), np.zeros(6))
    contact.roll(lambda t: still)
    assert contact.is_rolling
    ahead = (vertices - vertices.mean(axis=0)) @ (pose.rotation.T @ axes)[:, 0] > 0.0
    np.testing.assert_array_equal(contact.vertices, vertices[ahead])
    F, lower, upper = contact.force_inequalities(500.0)
    assert F.shape == (9 * ahead.sum(), contact.force_count) and len(lower) == len(upper) == len(F)
    assert len(contact.force_labels(len(F))) == len(F)
    np.testing.assert_allclose(contact.acceleration(tick), 0.0, atol=1e-9)
    contact.roll(None)
    assert not contact.is_rolling
    np.testing.assert_array_equal(contact.vertices, vertices)


def test_a_contact_moves_to_another_surface_of_the_world_while_it_is_off(robot):
    square = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    tread = Surface("tread", square, pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.1])), friction=0.2)
    contact, tick = Contact(robot.surface(FOOT)), standing(robot, 0)
    flat, steep = contact.acceleration(tick), contact.force_inequalities(1.0)[0].copy()
    with pytest.raises(InputError, match="lift a foot first"):
        contact.move_to(tread)
    contact.mode = "off"
    contact.move_to(tread)
    contact.mode = "fixed"
    assert contact.on is tread and contact.friction == 0.2
    assert contact.acceleration(tick)[2] == pytest.approx(flat[2] + 0.1 * contact.stiffness)
    assert np.abs(contact.force_inequalities(1.0)[0]).sum() < np.abs(steep).sum()
    with pytest.raises(InputError):
        contact.move_to(robot.surface(FOOT))


def test_a_lesser_friction_narrows_the_pyramids(robot):
    contact = Contact(robot.surface(FOOT), friction=0.5)
    before = contact.force_inequalities(1.0)[0].copy()
    contact.rely_on(0.2)
    after = contact.force_inequalities(1.0)[0]
    assert contact.friction == 0.2
    np.testing.assert_allclose(after[0, :2], before[0, :2])
    np.testing.assert_allclose(after[0, 2], 0.4 * before[0, 2])
