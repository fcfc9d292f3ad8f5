"""A limb's motion fitted to what is edited of its point: there where it can be, as planned before, after and beside."""

import numpy as np
import pytest

from sot.motion.body.limb import refit_limb
from sot.motion.body.limits import Limits
from sot.motion.edit import Edit, SampledOffset, edited_point_reference
from sot.robots.robot import Robot
from tests.sim.runs import still_motion

Z = 2


@pytest.fixture(scope="module")
def motion():
    return still_motion(Robot.load("hrp2"), 3.0)


def raised(motion, edit):
    """The hand's way as an edit wants it, and the motion whose arm takes it there."""
    path = edited_point_reference(motion.pose("right_hand"), [(edit.rows, SampledOffset.of(edit, motion))])
    arm = [motion.robot.joints[k] for k in motion.robot.groups["right_arm"]]
    return path, refit_limb(motion, arm, "right_hand", [(row, *edit.span) for row in edit.rows], path)


@pytest.mark.parametrize("axis", ["x", "z", "yaw"])
def test_a_limb_takes_its_point_where_it_is_wanted_and_does_nothing_else(motion, axis):
    edit = Edit("right_hand", axis, by=0.12, start=0.8, end=2.2)
    path, made = raised(motion, edit)
    reached = made.track("right_hand")
    rows = (motion.times >= 0.8) & (motion.times <= 2.2)
    wanted = [path(t) for t in motion.times[rows]]
    if axis == "yaw":
        off = [
            pose.rotation[:2, 0] - turned[:2, 0] for pose, turned in zip(wanted, reached.rotation[rows], strict=True)
        ]
    else:
        off = np.array([pose.position for pose in wanted])[:, edit.rows] - reached.position[rows][:, edit.rows]
    assert np.abs(off).max() < 0.004
    away = (motion.times < 0.5) | (motion.times > 2.5)
    np.testing.assert_allclose(made.q[away], motion.q[away], atol=5e-3)
    others = np.setdiff1d(np.arange(motion.robot.na), motion.robot.groups["right_arm"])
    np.testing.assert_array_equal(made.q[:, 7 + others], motion.q[:, 7 + others])
    np.testing.assert_array_equal(made.com, motion.com)


def test_what_comes_too_fast_is_begun_earlier_within_all_limits(motion):
    _, made = raised(motion, Edit("right_hand", "z", by=0.7, start=1.0, end=1.3))
    limits, eps = Limits.of(motion.robot), 1e-5
    assert np.all(np.abs(made.v[:, 6:]) <= limits.velocity[6:] + eps)
    assert np.all(np.abs(made.a[:, 6:]) <= limits.acceleration[6:] + eps)
    assert np.all(made.q[:, 7:] >= limits.lower[6:] - eps) and np.all(made.q[:, 7:] <= limits.upper[6:] + eps)
    risen = made.track("right_hand").position[:, Z] - motion.track("right_hand").position[:, Z]
    assert risen.max() > 0.3
    assert risen[motion.times <= 1.0].max() > 0.03
    np.testing.assert_allclose(np.gradient(made.q[:, 7:], motion.times, axis=0)[1:-1], made.v[1:-1, 6:], atol=0.05)
    np.testing.assert_allclose(np.gradient(made.v[:, 6:], motion.times, axis=0)[1:-1], made.a[1:-1, 6:], atol=5.0)
