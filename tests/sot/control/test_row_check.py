"""Rows of a wrong shape or type are one line at the first tick; values that are not finite never become a torque."""

import numpy as np
import pytest

from solvers import Cascade, Status, TaskCorrection, Weighted
from sot.control import Controller, MotionTask, Task
from sot.control import layout as layout_module
from sot.control.controller import HOLD_DAMPING
from sot.errors import InputError
from sot.robots import Robot
from tests.sot.stances import standing_stack


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


class Own(Task):
    """Rows of one's own, whatever they are."""

    def __init__(self, make, variable="acceleration", equality=False):
        super().__init__("own", "m/s²", "m")
        self.make, self.variable, self.equality = make, variable, equality

    def rows(self, tick):
        made = self.make(tick)
        return self.make_rows(*made) if isinstance(made, tuple) else made


class Observed(MotionTask):
    """A motion task of one's own, whatever it observes."""

    def __init__(self, change=lambda t, parts: parts):
        super().__init__("own", "m/s²", "m", 100.0)
        self.change = change

    def observe(self, tick):
        hand = tick.frame("left_hand")
        return self.change(tick.t, [np.zeros(3), np.zeros(3), hand.jacobian[:3], hand.drift[:3], np.zeros(3)])


def controller(robot, task, solver=None):
    stack = standing_stack(robot)
    if task.equality:
        stack.add(task, "own", before="posture")
    else:
        stack.hard.append(task)
    return Controller(robot, stack, solver or Cascade())


def bounds(count, value=np.inf):
    return np.full(count, -value), np.full(count, value)


REFUSED = {
    "columns of v̇": (
        Own(lambda tick: (np.ones((2, 30)), *bounds(2))),
        "task 'own': its Jacobian has 30 columns, the robot has 36 velocities",
    ),
    "columns of τ": (
        Own(lambda tick: (np.ones((2, 36)), *bounds(2)), "torque"),
        "task 'own': its matrix has 36 columns, the robot has 30 joints",
    ),
    "columns of φ": (
        Own(lambda tick: (np.ones((2, 12)), *bounds(2)), "force"),
        "task 'own': its matrix has 12 columns, the contacts have 24 force variables now",
    ),
    "fewer bounds than rows": (
        Own(lambda tick: (np.ones((3, 36)), np.zeros(3), np.ones(2))),
        "its Jacobian has 3 rows, its bounds 3 and 2",
    ),
    "one dimension": (Own(lambda tick: (np.ones(36), *bounds(1))), r"its Jacobian has shape \(36,\)"),
    "whole numbers": (
        Own(lambda tick: (np.ones((1, 36), dtype=int), *bounds(1))),
        "its Jacobian is an array of int64: make it an array of floats",
    ),
    "lists": (Own(lambda tick: (np.ones((1, 36)), [0.0], [1.0])), "its bounds are list"),
    "a list as matrix": (Own(lambda tick: ([[1.0] * 36], *bounds(1))), "its Jacobian is list"),
    "nothing returned": (Own(lambda tick: None), r"rows\(tick\) returned NoneType, not Rows"),
    "nan in a matrix": (Own(lambda tick: (np.full((1, 36), np.nan), *bounds(1))), "its Jacobian holds a value"),
    "nan in a bound": (Own(lambda tick: (np.ones((1, 36)), *bounds(1, np.nan))), "its bounds hold a value"),
    "an equality with other bounds": (
        Own(lambda tick: (np.ones((1, 36)), *bounds(1, 1.0)), equality=True),
        "its lower and upper bounds differ: a limit needs `equality = False`",
    ),
    "an equality with infinity": (
        Own(lambda tick: (np.ones((1, 36)), np.full(1, np.inf), np.full(1, np.inf)), equality=True),
        "what it wants .* not finite",
    ),
    "a Jacobian observed": (
        Observed(lambda t, parts: [*parts[:2], parts[2][:, :30], *parts[3:]]),
        "task 'own': its Jacobian has 30 columns, the robot has 36 velocities",
    ),
    "a drift observed": (
        Observed(lambda t, parts: [*parts[:3], np.zeros(6), parts[4]]),
        r"task 'own': observe\(tick\) returned float arrays of shapes \(3,\), \(3,\), \(3, 36\), \(6,\), \(3,\)",
    ),
    "too little observed": (Observed(lambda t, parts: parts[:4]), "task 'own': ValueError: not enough values"),
}


@pytest.mark.parametrize(("task", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_a_task_that_does_not_fit_is_one_line_at_the_first_tick(robot, task, message):
    with pytest.raises(InputError, match=message) as told:
        controller(robot, task)(0.0, robot.rest, np.zeros(robot.nv))
    assert "\n" not in str(told.value)


def test_later_ticks_check_nothing(robot, monkeypatch):
    checked = []
    monkeypatch.setattr(layout_module, "check_rows", lambda task, rows, columns: checked.append(task.name))
    own = controller(robot, Observed())
    for k in range(5):
        own(0.001 * k, robot.rest, np.zeros(robot.nv))
    assert sorted(checked) == sorted(task.name for task in (*own.stack.hard, *own.stack.tasks))


LATER = {
    "nan in the error": lambda parts: [np.full(3, np.nan), *parts[1:]],
    "infinite feed-forward": lambda parts: [*parts[:4], np.array([0.0, np.inf, 0.0])],
    "nan in the Jacobian": lambda parts: [*parts[:2], np.full((3, 36), np.nan), *parts[3:]],
    "a Jacobian with other columns": lambda parts: [*parts[:2], parts[2][:, :30], *parts[3:]],
    "another number of rows": lambda parts: [*parts[:2], parts[2][:2], *parts[3:]],
    "lists": lambda parts: [part.tolist() for part in parts],
}


@pytest.mark.parametrize("solver", [Cascade, Weighted, TaskCorrection])
@pytest.mark.parametrize("change", LATER.values(), ids=LATER.keys())
def test_later_on_the_last_torque_is_held_and_the_task_named(robot, change, solver):
    task = Observed(lambda t, parts: change(parts) if 0.0015 < t < 0.0035 else parts)
    own, v = controller(robot, task, solver()), np.full(robot.nv, 0.01)
    commands = [own(0.001 * k, robot.rest, v) for k in range(5)]
    assert [command.status == Status.INVALID for command in commands] == [False, False, True, True, False]
    for held in commands[2:4]:
        np.testing.assert_allclose(held.torque, commands[1].torque - HOLD_DAMPING * 0.01)
        assert held.invalid.startswith("task 'own': ")
        assert held.solution.levels[0].status == Status.INVALID and np.isnan(held.wrenches).all()
    np.testing.assert_allclose(commands[4].torque, commands[1].torque, atol=1e-6)
    assert not commands[4].invalid


@pytest.mark.parametrize("variable", ["acceleration", "torque", "force"])
@pytest.mark.parametrize("part", [0, 1, 2], ids=["matrix", "lower", "upper"])
def test_a_limit_with_nan_is_not_ignored(robot, part, variable):
    columns = {"acceleration": robot.nv, "torque": robot.na, "force": 24}[variable]

    def rows(tick):
        made = [np.zeros((2, columns)), np.full(2, -1.0), np.full(2, 1.0)]
        if tick.t > 0.0:
            made[part] = made[part].copy()
            made[part].flat[-1] = np.nan
        return tuple(made)

    own = controller(robot, Own(rows, variable))
    first = own(0.0, robot.rest, np.zeros(robot.nv))
    held = own(0.001, robot.rest, np.zeros(robot.nv))
    assert not first.invalid and held.invalid.startswith("task 'own': its ")
    np.testing.assert_array_equal(held.torque, first.torque)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("entry", [0, 2, 3, 6, 7, 20, 36, 37, 39, 42, 43, 60, 72])
def test_a_state_that_is_not_finite_holds_the_last_torque(robot, entry, value):
    own = controller(robot, Observed())
    first = own(0.0, robot.rest, np.zeros(robot.nv))
    state = np.concatenate([robot.rest, np.zeros(robot.nv)])
    state[entry] = value
    held = own(0.001, state[: robot.nq], state[robot.nq :])
    assert held.status == Status.INVALID and held.invalid == "the state holds a value that is not finite"
    np.testing.assert_array_equal(held.torque, first.torque)
    again = own(0.002, robot.rest, np.zeros(robot.nv))
    assert not again.invalid
    np.testing.assert_allclose(again.torque, first.torque, atol=1e-6)


class Broken:
    """A solver that fails after its first tick."""

    name = "broken"

    def __init__(self, fail):
        self.fail, self.solver, self.ticks = fail, Cascade(), 0

    def solve(self, levels):
        solution = self.solver.solve(levels)
        self.ticks += 1
        if self.ticks > 1:
            self.fail(solution)
        return solution


def raising(solution):
    raise np.linalg.LinAlgError("SVD did not converge")


def spoiling(solution):
    solution.x[3] = np.nan


@pytest.mark.parametrize(("fail", "says"), [(raising, "LinAlgError: SVD"), (spoiling, "its answer is not finite")])
def test_a_solver_that_breaks_is_held_and_named(robot, fail, says):
    own = controller(robot, Observed(), Broken(fail))
    first, second = (own(0.001 * k, robot.rest, np.zeros(robot.nv)) for k in range(2))
    assert second.invalid.startswith(f"solver 'broken': {says}")
    np.testing.assert_array_equal(second.torque, first.torque)


def test_what_a_task_raises_names_it_and_keeps_its_cause(robot):
    def fails(t, parts):
        raise IndexError("no such row")

    with pytest.raises(InputError, match="task 'own': IndexError: no such row") as told:
        controller(robot, Observed(fails))(0.0, robot.rest, np.zeros(robot.nv))
    assert isinstance(told.value.__cause__, IndexError)
