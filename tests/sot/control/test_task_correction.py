"""Task corrections as a layer of inverse dynamics: accelerations are corrected, the cascade finds forces for them."""

import numpy as np
import pytest

from solvers import Cascade, Status, TaskCorrection
from sot.control.controller import Controller
from sot.control.dynamics import FormName
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks import JointBounds
from tests.sot.stances import standing_stack
from tests.sot.states import standing_state

FORMS: tuple[FormName, ...] = ("condensed", "full")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def commands(robot: Robot, stack: Stack, form: FormName, *state: np.ndarray):
    return [Controller(robot, stack, solver(), form=form)(0.0, *state) for solver in (TaskCorrection, Cascade)]


def reaching_out(robot: Robot) -> tuple[Stack, int]:
    """Rest, and a posture that wants an elbow far beyond the end of its range."""
    joint = robot.joints.index("LARM3")
    wanted = robot.rest.copy()
    wanted[7 + joint] = robot.lower[joint] - 0.5
    return standing_stack(robot, at=wanted), joint


@pytest.mark.parametrize("form", FORMS)
def test_commands_what_the_cascade_does_where_no_joint_bound_is_active(robot, form):
    rng = np.random.default_rng(0)
    for _ in range(5):
        mine, other = commands(robot, standing_stack(robot), form, *standing_state(robot, rng, speed=0.05))
        assert mine.status == other.status == Status.SOLVED
        np.testing.assert_allclose(mine.acceleration, other.acceleration, atol=1e-6)
        np.testing.assert_allclose(mine.torque, other.torque, atol=1e-5)
        assert not any(level.needed_qp for level in mine.solution.levels)


@pytest.mark.parametrize("form", FORMS)
def test_corrects_the_posture_alone_where_that_suffices_and_forces_realise_it(robot, form):
    stack, joint = reaching_out(robot)
    q = robot.rest.copy()
    q[7 + joint] = robot.lower[joint] + 0.00201  # JointBounds keeps 0.002 rad
    v = np.zeros(robot.nv)
    mine, other = commands(robot, stack, form, q, v)
    rows = JointBounds(robot).rows(Tick(robot).update(0.0, q, v))
    assert mine.status == Status.SOLVED
    assert mine.acceleration[6 + joint] == pytest.approx(rows.lower[joint], abs=1e-5)
    levels = {level.name: level for level in mine.solution.levels}
    assert [name for name, level in levels.items() if level.needed_qp] == ["posture"]
    assert levels["posture"].error > 10.0  # against what was asked for, not against what was corrected
    assert all(levels[name].error < 1e-6 for name in ("balance", "trunk"))
    np.testing.assert_allclose(mine.acceleration, other.acceleration, atol=1e-5)
    np.testing.assert_allclose(mine.torque, other.torque, atol=1e-4)


def test_feet_stand_even_if_a_joint_has_to_stop_that_carries(robot):
    q, v = robot.rest.copy(), np.zeros(robot.nv)
    knee = robot.joints.index("LLEG3")
    v[6 + knee] = 0.9 * robot.velocity[knee]
    stack = standing_stack(robot)
    command = Controller(robot, stack, TaskCorrection())(0.0, q, v)
    tick = Tick(robot).update(0.0, q, v)
    for contact in stack.contacts:
        frame = tick.frame(contact.point)
        wanted = contact.acceleration(tick)
        np.testing.assert_allclose(frame.jacobian @ command.acceleration + frame.drift, wanted, atol=1e-6)
