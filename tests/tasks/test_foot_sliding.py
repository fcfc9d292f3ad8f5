"""A sliding foot: what the task moves and what its contact holds are all axes, each once."""

import numpy as np
import pinocchio as pin
import pytest

from solvers import Cascade, Status
from sot.control.contact import Contact
from sot.control.controller import Controller
from sot.control.pose import Pose
from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot, shipped_robot_names
from tasks import FootSliding
from tests.sot.stances import leaning, standing_stack
from tests.sot.states import random_state
from tests.tasks.checks import assert_jacobian_and_drift


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def still(position, rotation):
    pose = Pose(position, rotation, np.zeros(6), np.zeros(6))
    return lambda t: pose


def test_jacobian_and_drift(robot):
    tick, (q, v) = Tick(robot), random_state(robot, np.random.default_rng(0))
    frame = tick.update(0.0, q, v).frame("left_foot")
    task = FootSliding(robot, "left_foot", still(frame.position + np.array([0.1, 0.2, 0.3]), frame.rotation.copy()))
    tick.contacts = [Contact(robot.surface("left_foot"))]
    assert task.rows(tick).lower.shape == (0,)  # it stands
    tick.contacts[0].mode = "sliding"
    assert_jacobian_and_drift(task, tick, q, v)


def test_task_and_contact_share_the_axes(robot):
    contact = Contact(robot.surface("left_foot"))
    contact.mode = "sliding"
    task = FootSliding(robot, "left_foot", still(np.zeros(3), np.eye(3)))
    assert sorted([*contact.held_axes, *task.selected]) == [0, 1, 2, 3, 4, 5]


def test_only_a_point_of_the_robot_can_slide(robot):
    with pytest.raises(InputError, match="no point 'third_foot'"):
        FootSliding(robot, "third_foot", still(np.zeros(3), np.eye(3)))


def test_a_foot_slides_to_its_target_flat_on_the_floor(robot):
    """On the controller's own model: standing on the right foot, the left one moves 4 cm aside and turns."""
    q, v = leaning(robot, 1.0), np.zeros(robot.nv)
    tick = Tick(robot).update(0.0, q, v)
    start = tick.frame("left_foot").position.copy()
    target, turn = start + np.array([0.03, 0.04, 0.0]), pin.exp3(np.array([0.0, 0.0, 0.2]))
    stack = standing_stack(robot, at=q)
    stack.contact("left_foot").mode = "sliding"
    stack.add(FootSliding(robot, "left_foot", still(target, turn)), "feet", before="trunk")
    controller, period = Controller(robot, stack, Cascade(), 0.005), 0.005
    for k in range(200):
        command = controller(k * period, q, v)
        assert command.status <= Status.SECOND_SOLVER
        q = pin.integrate(robot.model, q, period * v + 0.5 * period**2 * command.acceleration)
        v = v + period * command.acceleration
        foot = controller.tick.frame("left_foot")
        assert abs(foot.position[2]) < 1e-3 and foot.rotation[2, 2] > np.cos(0.005)
    np.testing.assert_allclose(foot.position[:2], target[:2], atol=2e-3)
    np.testing.assert_allclose(foot.rotation, turn, atol=0.01)
