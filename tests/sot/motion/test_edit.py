"""Changes of a motion: their ways in and out, way-points and targets, derivatives, and what makes no sense."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.pose import Pose
from sot.errors import InputError
from sot.motion.edit import Edit, SampledOffset, edited_joint_reference, edited_point_reference
from sot.robots.robot import Robot
from tests.sim.runs import still_motion

STEP = 1e-3


@pytest.fixture(scope="module")
def motion():
    return still_motion(Robot.load("hrp2"), 4.0)


def values(change, times):
    return np.array([change(t).value for t in times])[:, 0]


def test_a_constant_comes_and_goes_smoothly(motion):
    change = SampledOffset.of(Edit("right_hand", "z", by=0.1, start=1.0, end=3.0, ease=0.5), motion)
    times = np.arange(0.5, 3.5, STEP)
    x = values(change, times)
    assert np.all(x[(times < 1.0) | (times > 3.0)] == 0.0)
    np.testing.assert_allclose(x[(times > 1.5) & (times < 2.5)], 0.1)
    np.testing.assert_allclose(values(change, [1.25, 2.75]), 0.05)
    assert np.abs(np.diff(x, 2)).max() / STEP**2 < 0.1 * 6.0 / 0.5**2  # the least jerk's acceleration, 5.8 / T²


def test_way_points_are_met_and_left_at_rest(motion):
    points = [(1.0, 0.1), (1.4, -0.05), (2.0, 0.2)]
    edit = Edit("left_hand", "x", through=points, ease=0.4)
    change = SampledOffset.of(edit, motion)
    np.testing.assert_allclose(edit.span, (0.6, 2.4))
    np.testing.assert_allclose(values(change, [t for t, _ in points]), [x for _, x in points], atol=1e-6)
    for end in (0.6 + STEP, 2.4 - STEP):
        np.testing.assert_allclose(np.ravel(change(end)), 0.0, atol=0.2)
    assert all(np.all(np.ravel(change(t)) == 0.0) for t in (0.59, 2.41, -1.0, 9.0))


@pytest.mark.parametrize(
    "edit",
    [
        Edit("head", "yaw", by=0.3, start=1.0, end=3.0),
        Edit("head", "yaw", by=lambda t: 0.2 * np.sin(9.0 * t), start=1.0, end=3.0),
        Edit("RARM3", through=[(1.5, 0.3), (2.5, -0.2)], ease=0.6),
        Edit("right_hand", target=(0.4, -0.3, 1.2), start=1.0, end=3.0),
    ],
    ids=["constant", "function", "way-points", "target"],
)
def test_rates_are_derivatives(motion, edit):
    change = SampledOffset.of(edit, motion)
    for t in np.linspace(0.8, 3.2, 41):
        before, now, after = change(t - STEP), change(t), change(t + STEP)
        np.testing.assert_allclose((after.value - before.value) / (2 * STEP), now.rate, atol=3e-3)
        np.testing.assert_allclose((after.rate - before.rate) / (2 * STEP), now.acceleration, atol=0.2)


def test_a_target_is_reached_whatever_the_reference_does(motion):
    target = np.array([0.4, -0.3, 1.2])
    edit = Edit("right_hand", target=tuple(target), start=1.0, end=3.0, ease=0.5)
    path = edited_point_reference(motion.pose("right_hand"), [(edit.rows, SampledOffset.of(edit, motion))])
    np.testing.assert_allclose(path(2.0).position, target, atol=1e-9)
    np.testing.assert_array_equal(path(0.5).position, motion.pose("right_hand")(0.5).position)
    np.testing.assert_array_equal(path(2.0).rotation, motion.pose("right_hand")(2.0).rotation)


def swaying(t):
    """A pose that moves in all six axes, with its derivatives."""
    w = np.array([0.7, -0.4, 0.5])
    velocity = np.concatenate([np.cos(3.0 * t) * np.array([0.3, 0.1, -0.2]) * 3.0, w])
    acceleration = np.concatenate([-np.sin(3.0 * t) * np.array([0.3, 0.1, -0.2]) * 9.0, np.zeros(3)])
    return Pose(np.sin(3.0 * t) * np.array([0.3, 0.1, -0.2]), pin.exp3(t * w), velocity, acceleration)


def test_an_edited_pose_is_consistent_in_all_axes(motion):
    edits = [
        Edit("head", axis, by=lambda t, k=k: 0.2 * np.sin((4.0 + k) * t), start=0.5, end=3.5)
        for k, axis in enumerate(("x", "y", "z", "roll", "pitch", "yaw"))
    ]
    path = edited_point_reference(swaying, [(edit.rows, SampledOffset.of(edit, motion)) for edit in edits])
    for t in np.linspace(0.6, 3.4, 30):
        before, now, after = path(t - STEP), path(t), path(t + STEP)
        turn = pin.log3(after.rotation @ before.rotation.T) / (2 * STEP)
        moved = np.concatenate([(after.position - before.position) / (2 * STEP), turn])
        np.testing.assert_allclose(moved, now.velocity, atol=2e-3)
        np.testing.assert_allclose((after.velocity - before.velocity) / (2 * STEP), now.acceleration, atol=0.1)
    np.testing.assert_allclose(path(2.0).rotation @ path(2.0).rotation.T, np.eye(3), atol=1e-12)


def test_only_the_edited_joint_moves(motion):
    robot = motion.robot
    change = SampledOffset.of(Edit("RARM3", by=-0.5, start=1.0, end=3.0), motion)
    wanted = edited_joint_reference(robot, motion.joints, {"RARM3": [change]})(2.0)
    off = wanted[0] - motion.joints(2.0)[0]
    joint = robot.joints.index("RARM3")
    assert off[joint] == pytest.approx(-0.5)
    assert np.count_nonzero(off) == 1


WRONG = {
    "no change": (dict(of="head", axis="z", start=0.0, end=1.0), "one of by, through and target"),
    "two changes": (dict(of="head", by=1.0, target=(0, 0, 1), start=0.0, end=1.0), "by and target"),
    "axis": (dict(of="head", axis="w", by=1.0, start=0.0, end=1.0), "head has no axis 'w'"),
    "axis of a target": (dict(of="head", axis="z", target=(0, 0, 1), start=0.0, end=1.0), "leave the axis out"),
    "no time": (dict(of="head", axis="z", by=1.0), "needs a start and an end"),
    "ends first": (dict(of="head", axis="z", by=1.0, start=2.0, end=1.0), "ends at 1 s, not after"),
    "nan": (dict(of="head", axis="z", by=1.0, start=float("nan"), end=1.0), "not after it starts"),
    "no ease": (dict(of="head", axis="z", by=1.0, start=0.0, end=1.0, ease=0.0), "ease is 0 s"),
    "unordered": (dict(of="head", axis="z", through=[(2.0, 1.0), (1.0, 0.0)]), "follow one another"),
    "two times": (dict(of="head", axis="z", through=[(2.0, 1.0)], start=1.0), "their own times"),
}


@pytest.mark.parametrize(("given", "said"), WRONG.values(), ids=WRONG.keys())
def test_what_makes_no_sense_says_so(given, said):
    with pytest.raises(InputError, match=said) as info:
        Edit(**given, source="mine.toml: edit 3")
    assert str(info.value).startswith("mine.toml: edit 3: ")


def test_what_the_robot_or_the_motion_has_not_is_named(motion):
    for edit, said in (
        (Edit("tail", "z", by=0.1, start=1.0, end=2.0), "no point 'tail'"),
        (Edit("tail", by=0.1, start=1.0, end=2.0), "no joint 'tail'"),
        (Edit("head", by=0.1, start=1.0, end=2.0), "which axis of head"),
        (Edit("head", "z", by=0.1, start=1.0, end=5.0), "from 1 to 5 s, the motion from 0 to 4 s"),
        (Edit("head", "z", through=[(0.1, 0.1)]), "from -0.2"),
    ):
        with pytest.raises(InputError, match=said):
            edit.check(motion.robot, motion.duration)
    with pytest.raises(InputError, match="finite"):
        SampledOffset.of(Edit("head", "z", by=lambda t: np.nan, start=1.0, end=2.0), motion)
    with pytest.raises(InputError, match="no number"):
        SampledOffset.of(Edit("head", "z", by=lambda t: "up", start=1.0, end=2.0), motion)
