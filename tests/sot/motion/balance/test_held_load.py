"""A load that goes with the chest: its share of the centre of mass and of the zero-moment point."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.held_load import HeldLoad
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def _load(robot: Robot, knots: int, mass: float = 5.0) -> HeldLoad:
    place = np.tile([0.3, 0.05, -0.2], (knots, 1))
    return HeldLoad(np.zeros(0, int), np.zeros((knots, 0)), np.full(knots, mass), "chest", place)


def test_the_combined_centre_of_mass_has_the_jacobian_of_finite_differences(robot: Robot) -> None:
    load, tick, still = _load(robot, 1), Tick(robot), np.zeros(robot.nv)
    q = pin.integrate(robot.model, robot.rest, 0.2 * np.random.default_rng(1).standard_normal(robot.nv))
    tick.update(0.0, q, still)
    com, J = (part.copy() for part in load.combined_com(tick, 0))
    step = 1e-6
    for k in range(robot.nv):
        moved = tick.update(0.0, pin.integrate(robot.model, q, step * np.eye(robot.nv)[k]), still)
        np.testing.assert_allclose((load.combined_com(moved, 0)[0] - com) / step, J[:, k], atol=1e-5)


def test_the_combined_centre_of_mass_is_that_of_a_model_with_the_load_in_its_chest(robot: Robot) -> None:
    load, tick = _load(robot, 1), Tick(robot).update(0.0, robot.rest, np.zeros(robot.nv))
    model, frame = pin.Model(robot.model), robot.model.frames[robot.point("chest")]
    whole = pin.Inertia(5.0, load.place[0], np.zeros((3, 3)))
    model.appendBodyToJoint(frame.parentJoint, whole, frame.placement)
    np.testing.assert_allclose(
        load.combined_com(tick, 0)[0], pin.centerOfMass(model, model.createData(), robot.rest), atol=1e-9
    )


def test_a_body_that_speeds_up_with_its_load_has_the_zero_moment_point_of_a_pendulum(robot: Robot) -> None:
    period, acceleration = 0.02, 0.4
    times = period * np.arange(101)
    shift = 0.5 * acceleration * times**2
    q = np.tile(robot.rest, (len(times), 1))
    q[:, 0] += shift
    tick = Tick(robot)
    own = np.tile(tick.com, (len(times), 1))
    own[:, 0] += shift
    nothing = np.zeros((len(times), 6))
    load = _load(robot, len(times))
    both = load.combined(robot, Centroidal(own, nothing, nothing, robot.mass), q, period, times)
    middle = len(times) // 2
    com = load.combined_com(tick, 0)[0] + [shift[middle], 0.0, 0.0]
    np.testing.assert_allclose(both.com[middle], com, atol=1e-9)
    np.testing.assert_allclose(both.zmp()[middle], com[:2] - [com[2] / GRAVITY * acceleration, 0.0], atol=1e-6)
    assert both.mass == robot.mass + 5.0


def test_a_load_swung_about_the_body_has_its_angular_momentum(robot: Robot) -> None:
    period, speed = 0.02, 0.5
    times = period * np.arange(101)
    place = np.tile([0.3, 0.0, -0.2], (len(times), 1))
    place[:, 1] += speed * times
    load = HeldLoad(np.zeros(0, int), np.zeros((len(times), 0)), np.full(len(times), 5.0), "chest", place)
    q, tick = np.tile(robot.rest, (len(times), 1)), Tick(robot)
    nothing = np.zeros((len(times), 6))
    state = Centroidal(np.tile(tick.com, (len(times), 1)), nothing, nothing, robot.mass)
    both = load.combined(robot, state, q, period, times)
    middle = len(times) // 2
    arm = tick.frame("chest").position + place[middle] - tick.com
    reduced = 5.0 * robot.mass / (5.0 + robot.mass)
    np.testing.assert_allclose(both.momentum[middle, 3:], reduced * np.cross(arm, [0.0, speed, 0.0]), atol=1e-6)


def test_a_push_leaves_the_pressure_behind_the_centre_of_mass_by_its_moment(robot: Robot) -> None:
    period, force = 0.02, -50.0
    times = period * np.arange(51)
    q, tick = np.tile(robot.rest, (len(times), 1)), Tick(robot)
    place, nothing = np.tile([0.3, 0.0, 0.0], (len(times), 1)), np.zeros((len(times), 6))
    back = np.tile([force, 0.0, 0.0], (len(times), 1))
    load = HeldLoad(np.zeros(0, int), np.zeros((len(times), 0)), np.zeros(len(times)), "chest", place, back)
    state = Centroidal(np.tile(tick.com, (len(times), 1)), nothing, nothing, robot.mass)
    zmp = load.combined(robot, state, q, period, times).zmp()[25]
    height, weight = float(tick.frame("chest").position[2]), robot.mass * GRAVITY
    np.testing.assert_allclose(zmp, tick.com[:2] + np.array([height * force / weight, 0.0]), atol=1e-9)
    np.testing.assert_allclose(tick.com[:2] - zmp, load.com_shift(height, weight)[0], atol=1e-9)
