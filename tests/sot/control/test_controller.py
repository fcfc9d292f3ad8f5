"""One tick from state to torque: the zero-moment point, the hold when there is no answer, and any control period."""

import numpy as np
import pinocchio as pin
import pytest

from solvers import Cascade, LevelResult, Solution, Status
from sot.control.controller import HOLD_DAMPING, Controller
from sot.robots.robot import Robot, shipped_robot_names
from tasks import TorqueRateBounds
from tests.sot.stances import leaning, standing_stack
from tests.sot.states import standing_state


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


class FailingAfter:
    """A solver that gives up after so many ticks, at a level."""

    name = "failing"

    def __init__(self, ticks, level=0):
        self.ticks, self.level, self.solver = ticks, level, Cascade()

    def solve(self, levels):
        solution = self.solver.solve(levels)
        self.ticks -= 1
        if self.ticks >= 0:
            return solution
        results = [
            LevelResult(r.level, r.x, False, 1.0, Status.FAILED if k >= self.level else r.status)
            for k, r in enumerate(solution.levels)
        ]
        return Solution(np.full_like(solution.x, np.nan) if not self.level else solution.x, results, Status.FAILED)


def test_without_an_answer_the_last_torque_is_held_and_damped(robot):
    controller = Controller(robot, standing_stack(robot), FailingAfter(1))
    rng = np.random.default_rng(0)
    solved = controller(0.0, *standing_state(robot, rng))
    assert solved.status <= Status.SECOND_SOLVER
    for k in range(1, 5):  # however long it lasts, the damping does not add up
        q, v = standing_state(robot, rng, speed=5.0)
        held = controller(0.001 * k, q, v)
        expected = np.clip(solved.torque - HOLD_DAMPING * v[6:], -robot.effort, robot.effort)
        np.testing.assert_allclose(held.torque, expected)
        assert held.status == Status.FAILED
        assert np.isnan(held.zmp).all() and np.isnan(held.wrenches).all()


def test_the_hold_is_clipped_and_starts_from_nothing(robot):
    controller = Controller(robot, standing_stack(robot), FailingAfter(0))
    v = np.zeros(robot.nv)
    np.testing.assert_array_equal(controller(0.0, robot.rest, v).torque, 0.0)
    v[6:] = -1e4
    np.testing.assert_array_equal(controller(0.001, robot.rest, v).torque, robot.effort)


def test_a_lower_level_without_an_answer_keeps_that_of_the_levels_above(robot):
    q, v = standing_state(robot, np.random.default_rng(1))
    expected = Controller(robot, standing_stack(robot), Cascade())(0.0, q, v)
    command = Controller(robot, standing_stack(robot), FailingAfter(0, level=3))(0.0, q, v)
    np.testing.assert_allclose(command.torque, expected.torque, atol=1e-9)
    assert command.status == Status.FAILED and np.isfinite(command.zmp).all()


def test_torques_stay_within_the_robot_s_limits(robot):
    rng = np.random.default_rng(2)
    controller = Controller(robot, standing_stack(robot), Cascade())
    for k in range(5):
        command = controller(0.001 * k, *standing_state(robot, rng, speed=1.0))
        assert np.all(np.abs(command.torque) <= robot.effort)


@pytest.mark.parametrize("rise_time", [0.01, 0.1])
def test_torques_change_no_faster_than_asked_and_get_there(robot, rise_time):
    def torques(*limits):
        stack, over = standing_stack(robot), []
        stack.hard += limits
        controller = Controller(robot, stack, Cascade())
        for k in range(301):
            if k == 1:  # joints are wanted elsewhere from one tick to the next
                stack.task("Posture").reference = robot.rest[7:] + 0.3
            over.append(controller(0.001 * k, robot.rest, np.zeros(robot.nv)))
        assert all(command.status == Status.SOLVED for command in over)
        return np.array([command.torque for command in over])

    free, bounded = torques(), torques(TorqueRateBounds(robot, rise_time))
    change = 0.001 / rise_time * robot.effort
    assert np.any(np.abs(np.diff(free, axis=0)) > 1.5 * change)
    assert np.all(np.abs(np.diff(bounded, axis=0)) <= change * (1.0 + 1e-6))
    np.testing.assert_allclose(bounded[-1], free[-1], atol=1e-6 * robot.effort.max())


def test_balance_does_not_pay_for_torque_rates(robot):
    q, v = standing_state(robot, np.random.default_rng(1), speed=2.0)
    free, bounded = standing_stack(robot), standing_stack(robot)
    bounded.hard.append(TorqueRateBounds(robot, rise_time=1e3))
    torques = []
    for stack in (free, bounded):
        controller = Controller(robot, stack, Cascade())
        controller(0.0, robot.rest, np.zeros(robot.nv))
        command = controller(0.001, q, v)
        assert command.status == Status.SOLVED
        torques.append(command.torque)
    np.testing.assert_allclose(torques[0], torques[1], atol=1e-9)


@pytest.mark.parametrize("form", ["pyramid", "unilateral"])
@pytest.mark.parametrize("share", [0.3, 0.5])
def test_zmp_is_where_the_contact_wrenches_have_no_tilting_moment(robot, form, share):
    q = leaning(robot, share)
    stack = standing_stack(robot, form, at=q)
    controller = Controller(robot, stack, Cascade())
    command = controller(0.0, q, np.random.default_rng(3).uniform(-0.02, 0.02, robot.nv))
    moment, force = np.zeros(3), np.zeros(3)
    for contact, wrench in zip(stack.contacts, command.wrenches, strict=True):
        place = controller.tick.frame(contact.point).position
        force += wrench[:3]
        moment += wrench[3:] + np.cross(place, wrench[:3])
    expected = np.array([-moment[1], moment[0]]) / force[2]
    np.testing.assert_allclose(command.zmp, expected, atol=1e-6)


def test_at_rest_the_zmp_is_under_the_centre_of_mass(robot):
    q = leaning(robot, 0.4)
    controller = Controller(robot, standing_stack(robot, at=q), Cascade())
    command = controller(0.0, q, np.zeros(robot.nv))
    np.testing.assert_allclose(command.zmp, controller.tick.com[:2], atol=1e-5)


def test_in_the_air_there_is_no_zmp(robot):
    stack = standing_stack(robot)
    for contact in stack.contacts:
        contact.mode = "off"
    command = Controller(robot, stack, Cascade())(0.0, robot.rest, np.zeros(robot.nv))
    assert np.isnan(command.zmp).all()
    np.testing.assert_array_equal(command.wrenches, np.zeros((2, 6)))


@pytest.mark.parametrize("form", ["condensed", "full"])
def test_the_command_moves_the_robot_as_it_says(robot, form):
    q, v = standing_state(robot, np.random.default_rng(4))
    controller = Controller(robot, standing_stack(robot), Cascade(), form=form)
    command, tick = controller(0.0, q, v), controller.tick
    forces = np.zeros(robot.nv)
    forces[6:] = command.torque
    for foot, wrench in zip(robot.feet, command.wrenches, strict=True):
        forces += tick.frame(foot).jacobian.T @ wrench
    np.testing.assert_allclose(np.linalg.solve(tick.M, forces - tick.h), command.acceleration, atol=1e-4)


@pytest.mark.parametrize(
    ("period", "name", "lean"),
    [
        (0.001, "hrp2", 0.42),
        (0.002, "hrp2_modified", 0.58),
        (0.005, "hrp2", 0.58),
        (0.005, "hrp2_modified", 0.42),
    ],
)
def test_any_period_brings_the_robot_back_to_rest(period, name, lean):
    """The controller on its own model, exactly integrated: from a lean to the middle, and at rest there."""
    robot = Robot.load(name)
    q, v = leaning(robot, lean), np.zeros(robot.nv)
    controller = Controller(robot, standing_stack(robot), Cascade(), period)
    goal, limits = controller.tick.com.copy(), robot.upper - robot.lower
    start = None
    for k in range(round(1.2 / period)):
        command = controller(k * period, q, v)
        assert command.status <= Status.SECOND_SOLVER
        start = controller.tick.com.copy() if start is None else start
        change = period * v + 0.5 * period**2 * command.acceleration
        q, v = pin.integrate(robot.model, q, change), v + period * command.acceleration
        assert np.all(q[7:] <= robot.upper) and np.all(q[7:] >= robot.lower) and np.all(np.abs(v[6:]) < robot.velocity)
    tick = controller.tick.update(1.2, q, v)
    assert np.linalg.norm(start - goal) > 0.01
    assert np.linalg.norm(tick.com - goal) < 2e-3
    assert np.abs(v).max() < 0.05 and np.abs(q[7:] - robot.rest[7:]).max() < 0.05 * limits.min()
    for foot in robot.feet:
        assert abs(tick.frame(foot).position[2]) < 1e-3


def test_a_foot_goes_on_as_it_arrived_in_the_tick_that_makes_its_contact(robot):
    stack, (q, v) = standing_stack(robot), standing_state(robot, np.random.default_rng(4))
    controller, contact, given = Controller(robot, stack, Cascade()), stack.contact("left_foot"), []
    for k, (mode, load) in enumerate((("off", 0.0), ("fixed", 0.0), ("fixed", 1.0))):
        contact.mode, contact.load = mode, load
        command = controller(0.001 * k, q, v)
        frame = controller.tick.frame("left_foot")
        given.append(frame.jacobian @ command.acceleration + frame.drift)
    np.testing.assert_allclose(given[1], given[0], atol=1e-6 * (1.0 + np.abs(given[0]).max()))
    assert np.abs(given[2] - given[0]).max() > 0.1
