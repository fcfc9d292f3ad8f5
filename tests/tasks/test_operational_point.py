"""Points of the robot: Jacobian, drift, errors, axes, and that they get where they are wanted."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.pose import Pose
from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot, shipped_robot_names
from tasks import OperationalPoint
from tests.sot.states import random_state
from tests.tasks.checks import assert_jacobian_and_drift, followed


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def placement(tick, point):
    frame = tick.frame(point)
    return pin.SE3(frame.rotation.copy(), frame.position.copy())


@pytest.mark.parametrize("axes", ["xyzRPY", "xyz", "RPY", "zx", "Y", "xyY"])
@pytest.mark.parametrize("point", ["right_hand", "head", "left_foot"])
def test_jacobian_and_drift(robot, point, axes):
    """Around the target: a rotation vector's rate is the angular velocity only to first order in the error."""
    tick, (q, v) = Tick(robot), random_state(robot, np.random.default_rng(0))
    target = placement(tick.update(0.0, q, v), point)
    target.translation += [0.3, -0.2, 0.1]
    assert_jacobian_and_drift(OperationalPoint(robot, point, target, axes), tick, q, v)


def test_error_is_reference_minus_measured_in_world_axes(robot):
    tick = Tick(robot).update(0.0, *random_state(robot, np.random.default_rng(1)))
    turn, shift = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.2, -0.3])
    target = placement(tick, "right_hand")
    target = pin.SE3(pin.exp3(turn) @ target.rotation, target.translation + shift)
    task = OperationalPoint(robot, "right_hand", target)
    task.rows(tick)
    np.testing.assert_allclose(task.error, [*shift, *turn], atol=1e-9)


@pytest.mark.parametrize(
    ("axes", "selected"), [("xyz", [0, 1, 2]), ("zx", [0, 2]), ("YPR", [3, 4, 5]), ("xyY", [0, 1, 5])]
)
def test_axes_select_rows(robot, axes, selected):
    tick = Tick(robot).update(0.0, *random_state(robot, np.random.default_rng(2)))
    target = pin.SE3(pin.exp3(np.array([0.1, 0.2, 0.3])), np.array([0.5, 0.2, 0.9]))
    every, some = OperationalPoint(robot, "left_hand", target), OperationalPoint(robot, "left_hand", target, axes)
    rows, part = every.rows(tick), some.rows(tick)
    np.testing.assert_array_equal(part.A, rows.A[selected])
    np.testing.assert_array_equal(part.lower, rows.lower[selected])
    np.testing.assert_array_equal(some.error, every.error[selected])


def test_on_its_trajectory_a_point_accelerates_as_the_reference(robot):
    tick = Tick(robot).update(0.0, *random_state(robot, np.random.default_rng(3)))
    frame, acceleration = tick.frame("head"), np.array([1.0, -2.0, 3.0, 0.5, -0.6, 0.7])
    pose = Pose(frame.position.copy(), frame.rotation.copy(), frame.velocity.copy(), acceleration)
    rows = OperationalPoint(robot, "head", lambda t: pose).rows(tick)
    np.testing.assert_allclose(rows.lower + frame.drift, acceleration, atol=1e-9)


def test_gains_act_on_position_and_velocity_errors(robot):
    tick = Tick(robot).update(0.4, *random_state(robot, np.random.default_rng(4)))
    frame, asked = tick.frame("head"), []
    offset, faster = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, -3.0, 0.3, 0.2, 0.1])

    def reference(t):
        asked.append(t)
        return Pose(frame.position + offset, frame.rotation.copy(), frame.velocity + faster, np.zeros(6))

    rows = OperationalPoint(robot, "head", reference, kp=50.0, kd=3.0).rows(tick)
    expected = 50.0 * np.append(offset, np.zeros(3)) + 3.0 * faster
    np.testing.assert_allclose(rows.lower + frame.drift, expected, atol=1e-9)
    assert asked == [0.4]


def test_a_placement_far_away_is_reached(robot):
    q, v = random_state(robot, np.random.default_rng(5), spread=0.5, speed=0.3)
    start = placement(Tick(robot).update(0.0, q, v), "right_hand")
    target = pin.SE3(
        pin.exp3(np.array([1.0, -0.8, 0.5])) @ start.rotation, start.translation + np.array([0.3, 0.2, 0.3])
    )
    errors = followed(OperationalPoint(robot, "right_hand", target), robot, q, v, 1.5, 0.005)
    assert np.linalg.norm(errors[0]) > 1.0
    assert np.linalg.norm(errors[-1]) < 2e-3


def test_units_follow_the_axes(robot):
    def units(axes):
        task = OperationalPoint(robot, "head", pin.SE3.Identity(), axes)
        return task.unit, task.error_unit

    assert (units("xy"), units("RY"), units("xY")) == (("m/s²", "m"), ("rad/s²", "rad"), ("SI", "m, rad"))


def test_a_target_is_the_user_s_to_change_afterwards(robot):
    target, tick = pin.SE3.Identity(), Tick(robot)
    task = OperationalPoint(robot, "head", target)
    task.rows(tick)
    before = task.error.copy()
    target.translation[:] = 7.0
    task.rows(tick)
    np.testing.assert_array_equal(task.error, before)


def test_wrong_points_and_axes_are_refused(robot):
    with pytest.raises(InputError, match="no point 'tail'"):
        OperationalPoint(robot, "tail", pin.SE3.Identity())
    for axes in ("", "xx", "xyw"):
        with pytest.raises(InputError, match=f"axes '{axes}' of head: choose some of xyzRPY"):
            OperationalPoint(robot, "head", pin.SE3.Identity(), axes)
    with pytest.raises(InputError, match="a target position has no orientation"):
        OperationalPoint(robot, "head", np.zeros(3))
    OperationalPoint(robot, "head", np.zeros(3), "xyz")


def test_a_limb_alone_adds_what_the_others_were_commanded(robot):
    """With the other joints and the base as commanded a tick ago, its rows ask for what those of the whole body do."""
    rng = np.random.default_rng(6)
    tick = Tick(robot).update(0.0, *random_state(robot, rng))
    tick.acceleration = rng.standard_normal(robot.nv)
    target = placement(tick, "right_hand")
    target.translation[:] += 0.1
    whole = OperationalPoint(robot, "right_hand", target, "xz").rows(tick)
    alone = OperationalPoint(robot, "right_hand", target, "xz", joints="right_arm").rows(tick)
    arm = 6 + robot.joint_numbers("right_arm")
    assert np.abs(np.delete(alone.A, arm, axis=1)).max() == 0.0
    np.testing.assert_array_equal(alone.A[:, arm], whole.A[:, arm])
    acceleration = tick.acceleration.copy()
    acceleration[arm] = rng.standard_normal(len(arm))
    np.testing.assert_allclose(alone.A @ acceleration - alone.lower, whole.A @ acceleration - whole.lower, atol=1e-9)
    with pytest.raises(InputError, match="no joint group 'tail'"):
        OperationalPoint(robot, "right_hand", target, joints="tail")
