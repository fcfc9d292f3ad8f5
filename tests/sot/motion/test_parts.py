import numpy as np
import pinocchio as pin
import pytest

from sot.motion.branches import choose
from sot.motion.contacts import planted
from sot.motion.coordinates import from_configuration, to_configuration
from sot.motion.limits import STRAIGHT, Limits
from sot.motion.parts import Arm, Body, Head
from sot.motion.retarget import PartFit, follow, solve_at
from sot.motion.spline import Spline
from sot.motion.stance import Build, on_time_line, over_feet
from sot.motion.targets import targets
from sot.robot import Robot
from tests.sot.motion.humans import dancer

STEP = 1e-6
PERIOD = 0.02


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def wanted(robot):
    build = Build.of(robot)
    return targets(on_time_line(over_feet(dancer(), build), 1.0 / PERIOD), robot, build)


@pytest.fixture
def rest(robot, wanted):
    return np.tile(from_configuration(robot.rest[None]), (wanted.length, 1))


def upright(wanted):
    return np.tile(np.eye(3), (wanted.length, 1, 1))


def make(name, robot, wanted, chest):
    phase = planted(robot, 1.0)[0]
    build = Build.of(robot)
    if name == "arm":
        return Arm(robot, "left", wanted, chest)
    if name == "head":
        return Head(robot, wanted, chest)
    return Body(robot, build, wanted, phase, np.zeros((wanted.length, 2)) if name == "balanced body" else None)


@pytest.mark.parametrize("name", ["body", "balanced body", "head", "arm"])
def test_jacobians_against_finite_differences(robot, wanted, name):
    rng = np.random.default_rng(0)
    part = make(name, robot, wanted, upright(wanted))
    y = np.concatenate([rng.uniform(-0.3, 0.3, 6), rng.uniform(robot.lower, robot.upper)])
    size = len(part.columns)
    e, J, unused = np.zeros(part.rows), np.zeros((part.rows, size)), np.zeros((part.rows, size))
    part.evaluate(70, y, e, J)
    for i, column in enumerate(part.columns):
        ends = []
        for sign in (-1.0, 1.0):
            moved = y.copy()
            moved[column] += sign * STEP
            part.evaluate(70, moved, e, unused)
            ends.append(e.copy())
        np.testing.assert_allclose(J[:, i], (ends[1] - ends[0]) / (2 * STEP), atol=1e-5 * np.abs(J).max())


def test_arm_moves_what_points_it_and_no_more(robot, wanted):
    arm = make("arm", robot, wanted, upright(wanted))
    assert [robot.joints[column - 6] for column in arm.columns] == ["LARM0", "LARM1", "LARM2", "LARM3"]


def test_solution_points_the_arm(robot, wanted, rest):
    arm = make("arm", robot, wanted, upright(wanted))
    limits = Limits.of(robot)
    y = rest[100].copy()
    for _ in range(3):
        solve_at(arm, 100, y, limits)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, to_configuration(y[None])[0])
    shoulder, elbow, wrist = (data.oMf[robot.point(f"left_{p}")].translation for p in ("shoulder", "elbow", "wrist"))
    for near, far, segment in ((shoulder, elbow, "left_upper_arm"), (elbow, wrist, "left_forearm")):
        along = (far - near) / np.linalg.norm(far - near)
        assert np.degrees(np.arccos(along @ wanted.directions[segment][100])) < 1.0


def test_body_follows_with_its_feet_on_the_floor(robot, wanted, rest):
    limits = Limits.of(robot)
    path = follow(make("body", robot, wanted, None), rest, limits)
    data, phase = robot.model.createData(), planted(robot, 1.0)[0]
    joints = path[:, 6:]
    assert np.all(joints >= limits.lower[6:] - 1e-3) and np.all(joints <= limits.upper[6:] + 1e-3)
    for q in to_configuration(path[::10]):
        pin.framesForwardKinematics(robot.model, data, q)
        for foot, pose in phase.feet.items():
            assert np.linalg.norm(data.oMf[robot.point(foot)].translation - pose.translation) < 1e-3


def test_a_wrong_branch_is_left_for_the_best_path(robot, wanted, rest):
    """From the rest posture, the chosen path of an arm is nowhere far from what is asked."""
    arm, limits = make("arm", robot, wanted, upright(wanted)), Limits.of(robot)
    path = choose(arm, rest, limits, PERIOD)
    np.testing.assert_array_equal(path[0], rest[0])
    fit = PartFit(arm.columns, wanted.length, PERIOD, limits)
    spline = fit.improve(arm, Spline.through(path[:, arm.columns], PERIOD), path, 3)
    assert np.all(np.abs(spline.velocities) <= limits.velocity[arm.columns] + 1e-6)
    e, J = np.zeros(arm.rows), np.zeros((arm.rows, len(arm.columns)))
    errors = []
    for k, x in enumerate(spline.knots):
        y = rest[k].copy()
        y[arm.columns] = x
        arm.evaluate(k, y, e, J)
        errors.append(np.linalg.norm(e[:6]) * 0.05)
    assert np.degrees(np.mean(errors)) < 3.0


def test_limits_stay_inside_the_robots_and_keep_knees_bent(robot):
    limits = Limits.of(robot)
    assert np.all(limits.lower[6:] >= robot.lower) and np.all(limits.upper[6:] <= robot.upper)
    assert np.all(limits.velocity[6:] < robot.velocity)
    assert np.all(np.isinf(limits.velocity[:6]))
    knee = robot.joints.index("LLEG3")
    q = robot.rest.copy()
    q[7 + knee] = limits.lower[6 + knee]
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    hip, ankle = (data.oMf[robot.point(f"left_{p}")].translation for p in ("hip", "ankle"))
    assert np.linalg.norm(ankle - hip) / Build.of(robot).leg == pytest.approx(STRAIGHT, abs=2e-3)
