"""Ticks that cannot have what they ask for: the planted cause is named, and the run goes on."""

import numpy as np
import pytest

from solvers import Cascade, Status
from solvers.conflict import find_conflict
from sot.control.controller import Controller
from sot.control.dynamics import Dynamics
from sot.control.task import Task
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tests.sot.stances import standing_stack
from tests.sot.states import standing_state


class Planted(Task):
    """Demands an acceleration of one axis of a point, or of one joint."""

    equality = False

    def __init__(self, row, least, gives_way):
        super().__init__("Planted", "m/s²", "m")
        self.row, self.least, self.gives_way = row, least, gives_way

    def rows(self, tick):
        return self.make_rows(self.row(tick)[None], np.array([self.least]), np.array([np.inf]))


def on_foot(foot, axis):
    return lambda tick: tick.frame(foot).jacobian[axis]


def on_joint(joint):
    def row(tick):
        out = np.zeros(tick.robot.nv)
        out[6 + joint] = 1.0
        return out

    return row


@pytest.mark.parametrize("ticks", [9, pytest.param(50, marks=pytest.mark.slow)])
def test_the_planted_cause_is_named_in_every_tick(ticks):
    robot, rng = Robot.load("hrp2"), np.random.default_rng(0)
    for case in range(ticks):
        stack, tick = standing_stack(robot), Tick(robot)
        if case % 3 == 0:
            foot, axis = robot.feet[case % 2], int(rng.integers(6))
            planted, against = Planted(on_foot(foot, axis), 5000.0, case % 2), f"Contact {foot}"
        elif case % 3 == 1:
            planted, against = Planted(on_joint(int(rng.integers(robot.na))), 3000.0, 1), "JointBounds"
        else:
            stack = standing_stack(robot, fraction=0.02)
            planted, against = Planted(lambda tick: tick.com_jacobian[2], 30.0, 0), "TorqueBounds"
        stack.hard.append(planted)
        tick.contacts = stack.contacts
        tick.update(0.0, *standing_state(robot, rng))
        levels = Dynamics(robot).assemble(tick, stack.contacts, stack.hard, stack.levels)
        conflict = find_conflict(levels)
        assert {"Planted", against} <= conflict.owners
        assert any(row.bound_change for row in conflict.rows)


def test_rows_are_told_by_joint_axis_and_unit():
    robot = Robot.load("hrp2")
    stack, tick = standing_stack(robot), Tick(robot)
    stack.hard.append(Planted(on_joint(robot.joints.index("RARM0")), 3000.0, 0))
    tick.contacts = stack.contacts
    tick.update(0.0, robot.rest, np.zeros(robot.nv))
    conflict = find_conflict(Dynamics(robot).assemble(tick, stack.contacts, stack.hard, stack.levels))
    assert str(conflict).startswith("JointBounds: RARM0 upper +") and "rad/s²" in str(conflict)


def test_a_controller_goes_on_and_tells_why_now_and_then():
    robot = Robot.load("hrp2")
    stack = standing_stack(robot)
    stack.hard.append(Planted(on_foot("left_foot", 2), 5.0, 1))
    controller = Controller(robot, stack, Cascade())
    commands = [controller(0.001 * k, robot.rest, np.zeros(robot.nv)) for k in range(3)]
    assert all(command.status == Status.RELAXED for command in commands)
    assert "Planted" in find_conflict([commands[0].unsolved]).owners  # ticks later: it is a copy
    assert commands[1].unsolved is None and commands[2].unsolved is None
    assert controller(1.2, robot.rest, np.zeros(robot.nv)).unsolved is not None


@pytest.mark.parametrize("solved", [True, False])
def test_status_lists_every_task_with_rows_errors_and_units(solved):
    robot = Robot.load("hrp2")
    stack, tick = standing_stack(robot), Tick(robot)
    tick.contacts = stack.contacts
    tick.update(0.0, robot.rest, np.zeros(robot.nv))
    solution = Cascade().solve(Dynamics(robot).assemble(tick, stack.contacts, stack.hard, stack.levels))
    lines = stack.status(tick, solution if solved else None).splitlines()
    assert lines[0].split()[:6] == ["level", "task", "weight", "rows", "error", "unit"]
    for task in (*stack.hard, *stack.tasks):
        line = next(line for line in lines if f" {task.name} " in line)
        assert line.endswith(f" {task.error_unit}") != solved
        assert f" {len(task.rows(tick).lower)} " in line
