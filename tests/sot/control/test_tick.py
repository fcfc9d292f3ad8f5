"""Model quantities against Pinocchio's recursive dynamics and against finite differences."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from solvers import Cascade
from sot.control.controller import Controller
from sot.control.quantities.bias import COMPENSATION_RATE_LIMIT, COULOMB_SPEED, coulomb_speeds
from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot, shipped_robot_names
from tests.sot.stances import standing_stack
from tests.sot.states import random_state, rate, turned

STATES = 3


@pytest.fixture(
    params=[(name, seed) for name in shipped_robot_names() for seed in range(STATES)], ids=lambda p: f"{p[0]}-{p[1]}"
)
def case(request):
    name, seed = request.param
    robot = Robot.load(name)
    return Tick(robot), *random_state(robot, np.random.default_rng(seed))


def test_mass_matrix_and_forces_are_those_of_inverse_dynamics_and_joint_losses(case):
    tick, q, v = case
    robot = tick.robot
    lossless = robot.model.copy()
    lossless.damping = np.zeros(robot.nv)
    data = lossless.createData()
    acceleration = np.random.default_rng(0).uniform(-5, 5, robot.nv)
    tick.update(0.0, q, v)
    losses = np.zeros(robot.nv)
    losses[6:] = robot.damping * v[6:] + robot.friction * np.tanh(v[6:] / COULOMB_SPEED)
    expected = pin.rnea(lossless, data, q, v, acceleration) + losses
    np.testing.assert_allclose(tick.M @ acceleration + tick.h, expected, atol=1e-9)
    np.testing.assert_allclose(tick.M, tick.M.T, atol=1e-12)
    assert np.linalg.eigvalsh(tick.M)[0] > 0.0


def test_losses_oppose_the_joints_and_only_them(case):
    tick, q, v = case
    robot = tick.robot
    lossless = pin.rnea(robot.model, robot.model.createData(), q, v, np.zeros(robot.nv))
    losses = tick.update(0.0, q, v).h - lossless
    np.testing.assert_allclose(losses[:6], 0.0, atol=1e-9)
    assert np.all(losses[6:] * v[6:] >= 0.0)
    fast = np.abs(v[6:]) > 5.0 * COULOMB_SPEED
    expected = (robot.friction + robot.damping * np.abs(v[6:]))[fast]
    np.testing.assert_allclose(np.abs(losses[6:])[fast], expected, rtol=1e-3, atol=1e-9)


def test_friction_of_light_joints_is_compensated_less_steeply():
    """No joint without the friction that is compensated would speed up faster than the limit; heavy ones are left."""
    robot = Robot.load("hrp2")
    np.testing.assert_array_equal(coulomb_speeds(robot), COULOMB_SPEED)
    rough = replace(robot, friction=30.0 * robot.friction)
    speeds = coulomb_speeds(rough)
    assert (speeds > 2.0 * COULOMB_SPEED).any()
    Minv = pin.computeMinverse(robot.model, robot.model.createData(), robot.rest)
    rates = rough.friction / speeds * np.diag(Minv)[6:]
    assert rates.max() == pytest.approx(COMPENSATION_RATE_LIMIT)


def test_gravity_forces_are_the_gradient_of_the_potential_energy(case):
    tick, q, v = case
    robot = tick.robot
    forces = tick.update(0.0, q, 0.0 * v).h.copy()
    step = 1e-5
    heights = [tick.update(0.0, pin.integrate(robot.model, q, s * step * v), v).com[2] for s in (1, -1)]
    power = robot.mass * 9.81 * (heights[0] - heights[1]) / (2.0 * step)
    assert forces @ v == pytest.approx(power, abs=1e-5)


@pytest.mark.parametrize("point", ["waist", "head_top", "left_hand", "right_foot"])
def test_frames_move_as_their_velocity_jacobian_and_drift_say(case, point):
    tick, q, v = case
    state = tick.update(0.0, q, v).frame(point)
    velocity, jacobian, drift = state.velocity.copy(), state.jacobian.copy(), state.drift.copy()
    np.testing.assert_allclose(jacobian @ v, velocity, atol=1e-10)
    np.testing.assert_allclose(rate(tick, q, v, lambda t: t.frame(point).position), velocity[:3], atol=1e-7)
    np.testing.assert_allclose(turned(tick, point, q, v), velocity[3:], atol=1e-7)
    np.testing.assert_allclose(rate(tick, q, v, lambda t: t.frame(point).velocity), drift, atol=1e-6)
    assert np.linalg.norm(drift) > 1e-2  # a drift of zero would prove nothing


def test_centre_of_mass_moves_as_its_velocity_jacobian_and_drift_say(case):
    tick, q, v = case
    tick.update(0.0, q, v)
    velocity, jacobian, drift = tick.com_velocity.copy(), tick.com_jacobian.copy(), tick.com_drift.copy()
    np.testing.assert_allclose(jacobian @ v, velocity, atol=1e-10)
    np.testing.assert_allclose(rate(tick, q, v, lambda t: t.com.copy()), velocity, atol=1e-7)
    np.testing.assert_allclose(rate(tick, q, v, lambda t: t.com_velocity.copy()), drift, atol=1e-6)
    assert np.linalg.norm(drift) > 1e-3


def test_centroidal_momentum_is_that_of_the_bodies_and_changes_as_its_drift_says(case):
    tick, q, v = case
    robot = tick.robot
    momentum, matrix, drift = (part.copy() for part in tick.update(0.0, q, v).centroidal())
    np.testing.assert_allclose(matrix @ v, momentum, atol=1e-9)
    np.testing.assert_allclose(momentum, _momentum_of_the_bodies(robot, q, v), atol=1e-9)
    np.testing.assert_allclose(momentum[:3], robot.mass * tick.com_velocity, atol=1e-9)
    np.testing.assert_allclose(rate(tick, q, v, lambda t: t.centroidal()[0]), drift, atol=1e-4)
    assert np.linalg.norm(drift[3:]) > 0.1


def _momentum_of_the_bodies(robot, q, v):
    """Sum over the bodies about the common centre of mass, from their own masses, inertias and velocities."""
    model, data = robot.model, robot.model.createData()
    pin.forwardKinematics(model, data, q, v)
    centre = pin.centerOfMass(model, data, q).copy()
    momentum = np.zeros(6)
    for k in range(1, model.njoints):
        inertia, place, twist = model.inertias[k], data.oMi[k], data.v[k]
        R, lever = place.rotation, place.act(inertia.lever) - centre
        linear = inertia.mass * R @ (twist.linear + np.cross(twist.angular, inertia.lever))
        momentum[:3] += linear
        momentum[3:] += R @ inertia.inertia @ twist.angular + np.cross(lever, linear)
    return momentum


def test_asking_for_one_quantity_does_not_spoil_another(case):
    tick, q, v = case
    names = ("frame", "com", "momentum")

    def ask(order):
        tick.update(0.0, q, v)
        answers = {
            "frame": lambda: np.concatenate([tick.frame("left_hand").velocity, tick.frame("left_hand").drift]),
            "com": lambda: np.concatenate([tick.com_jacobian.ravel(), tick.com_drift]),
            "momentum": lambda: np.concatenate([part.ravel() for part in tick.centroidal()]),
        }
        found = {name: answers[name]().copy() for name in order}
        return {**found, "M": tick.M.copy(), "foot": tick.frame("left_foot").drift.copy()}

    first, second = ask(names), ask(names[::-1])
    for name, value in first.items():
        np.testing.assert_array_equal(second[name], value, err_msg=name)


def test_update_forgets_the_last_state(case):
    tick, q, v = case
    robot = tick.robot
    tick.update(0.0, robot.rest, np.zeros(robot.nv))
    _ = tick.com_jacobian, tick.frame("left_hand"), tick.centroidal()
    tick.update(1.5, q, v)
    fresh = Tick(robot)
    fresh.update(1.5, q, v)
    assert tick.t == 1.5
    np.testing.assert_array_equal(tick.M, fresh.M)
    np.testing.assert_array_equal(tick.h, fresh.h)
    np.testing.assert_array_equal(tick.com, fresh.com)
    np.testing.assert_array_equal(tick.com_jacobian, fresh.com_jacobian)
    np.testing.assert_array_equal(tick.frame("left_hand").position, fresh.frame("left_hand").position)
    np.testing.assert_array_equal(tick.frame("left_hand").drift, fresh.frame("left_hand").drift)
    for mine, other in zip(tick.centroidal(), fresh.centroidal(), strict=True):
        np.testing.assert_array_equal(mine, other)


def test_a_quantity_is_computed_once_per_state(case):
    tick, q, v = case
    tick.update(0.0, q, v)
    assert tick.frame("left_hand") is tick.frame("left_hand")
    assert tick.com_jacobian is tick.com_jacobian
    assert tick.centroidal()[1] is tick.centroidal()[1]


def test_what_a_tick_has_told_outlives_it():
    """Its arrays lie in Pinocchio's memory, which others are given once nothing holds it."""
    robot = Robot.load("hrp2")
    tick = Tick(robot)
    wanted = [tick.com.copy(), tick.M.copy(), tick.frame("waist").position.copy(), tick.frame("waist").rotation.copy()]
    kept = []
    for k in range(50):
        kept.append(
            [Tick(robot).com, Tick(robot).M, Tick(robot).frame("waist").position, Tick(robot).frame("waist").rotation]
        )
        kept.append([np.full(n, np.nan) for n in (3, 9, 40 + k)])
    for values in kept[::2]:
        for value, right in zip(values, wanted, strict=True):
            np.testing.assert_array_equal(value, right)


def test_a_point_that_does_not_exist_is_named():
    with pytest.raises(InputError, match="no point 'tail'"):
        Tick(Robot.load("hrp2")).frame("tail")


@pytest.mark.parametrize("form", ["pyramid", "unilateral"])
def test_forces_of_a_contact_are_where_the_tick_says(form):
    """What the floor does to each foot, from the solver's φ and the columns alone."""
    robot = Robot.load("hrp2")
    stack = standing_stack(robot, form)
    controller = Controller(robot, stack, Cascade())
    command = controller(0.0, robot.rest, np.zeros(robot.nv))
    tick = controller.tick
    forces = controller.dynamics.decode(command.solution.x).forces
    assert tick.force_count == len(forces)
    for foot, wrench in zip(robot.feet, command.wrenches, strict=True):
        np.testing.assert_allclose(tick.contact(foot).wrench_map(tick) @ forces[tick.force_columns(foot)], wrench)
    stack.contact("left_foot").mode = "off"
    left, right = tick.force_columns("left_foot"), tick.force_columns("right_foot")
    assert left.start == left.stop and right.stop - right.start == tick.force_count
    with pytest.raises(InputError, match="no contact 'hand': there are left_foot, right_foot"):
        tick.force_columns("hand")
