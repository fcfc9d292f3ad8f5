from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
import quadprog

from sot.motion.body.branches import choose_arm_path
from sot.motion.body.coordinates import from_configuration, to_configuration
from sot.motion.body.limits import MAX_LEG_EXTENSION, Limits
from sot.motion.body.parts import Arm, Body, Head, Leg
from sot.motion.body.retarget import PartFit, bounded_step, solve_knots
from sot.motion.body.spline import Spline
from sot.motion.body.targets import targets_of_human
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.stance import Build, human_on_time_line, human_over_feet
from sot.motion.feet.swing import standing_paths
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import dancer

STEP = 1e-6
PERIOD = 0.02


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def wanted(robot):
    build = Build.of(robot)
    human = human_on_time_line(human_over_feet(dancer(), build), 1.0 / PERIOD)
    return targets_of_human(human, robot, build, np.zeros(human.count))


@pytest.fixture
def rest(robot, wanted):
    return np.tile(from_configuration(robot.rest[None]), (wanted.length, 1))


def make(name, robot, wanted):
    feet = standing_paths(planted_phases(robot, 1.0)[0], wanted.length)
    build = Build.of(robot)
    if name == "arm":
        return Arm(robot, "left", wanted)
    if name == "head":
        return Head(robot, wanted)
    if name == "leg":
        ways = {f"left_{part}": wanted.directions["left_forearm"] for part in ("thigh", "shank")}
        return Leg(robot, "left", ways, wanted.frames["chest"])
    return Body(robot, build, wanted, feet, np.zeros((wanted.length, 2)) if name == "balanced body" else None)


@pytest.mark.parametrize("name", ["body", "balanced body", "head", "arm", "leg"])
def test_jacobians_against_finite_differences(robot, wanted, name):
    rng = np.random.default_rng(0)
    part = make(name, robot, wanted)
    y = np.hstack([rng.uniform(-0.3, 0.3, (2, 6)), rng.uniform(robot.lower, robot.upper, (2, robot.na))])
    knots = np.array([70, 110])
    _, J = part.evaluate(knots, y)
    for i, column in enumerate(part.columns):
        step = STEP * np.eye(robot.nv)[column]
        before, after = (part.evaluate(knots, y + sign * step)[0] for sign in (-1.0, 1.0))
        np.testing.assert_allclose(J[:, :, i], (after - before) / (2 * STEP), atol=1e-5 * np.abs(J).max())


def test_the_hips_height_counts_by_the_error_that_is_accepted(robot, wanted, rest):
    bodies = [make("body", robot, replace(wanted, height=height)) for height in (0.02, 0.01)]
    coarse, fine = (body.evaluate(np.array([70, 110]), rest[[70, 110]] + 0.1)[0] for body in bodies)
    (height,) = np.flatnonzero((coarse != fine).any(axis=0))
    np.testing.assert_allclose(fine[:, height], 2.0 * coarse[:, height])


def test_arm_moves_what_points_it_and_no_more(robot, wanted):
    arm = make("arm", robot, wanted)
    assert [robot.joints[column - 6] for column in arm.columns] == ["LARM0", "LARM1", "LARM2", "LARM3"]


def test_solution_points_the_arm(robot, wanted, rest):
    arm = make("arm", robot, wanted)
    limits = Limits.of(robot)
    y = rest[100:101].copy()
    y[:, arm.columns], _ = solve_knots(arm, np.array([100]), y, limits)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, to_configuration(y)[0])
    shoulder, elbow, wrist = (data.oMf[robot.point(f"left_{p}")].translation for p in ("shoulder", "elbow", "wrist"))
    for near, far, segment in ((shoulder, elbow, "left_upper_arm"), (elbow, wrist, "left_forearm")):
        along = (far - near) / np.linalg.norm(far - near)
        assert np.degrees(np.arccos(along @ wanted.directions[segment][100])) < 1.0


def test_body_solved_has_its_feet_on_the_floor(robot, wanted, rest):
    limits, body = Limits.of(robot), make("body", robot, wanted)
    path = rest.copy()
    path[:, body.columns], _ = solve_knots(body, np.arange(wanted.length), rest, limits)
    data, phase = robot.model.createData(), planted_phases(robot, 1.0)[0]
    assert np.all(path >= limits.lower) and np.all(path <= limits.upper)
    for q in to_configuration(path[::10]):
        pin.framesForwardKinematics(robot.model, data, q)
        for foot, pose in phase.feet.items():
            assert np.linalg.norm(data.oMf[robot.point(foot)].translation - pose.translation) < 1e-3


@pytest.mark.parametrize("stiff", [1.0, 100.0])
def test_bounded_steps_are_those_of_a_quadratic_programme(stiff):
    """Also where some rows are far stiffer than others, as feet are, and active sets go round in circles."""
    rng = np.random.default_rng(0)
    n, size = 400, 7
    A, g = rng.normal(size=(n, 9, size)), 3.0 * rng.normal(size=(n, size))
    A[:, :4] *= stiff
    g[:] += stiff * (A[:, :4].transpose(0, 2, 1) @ rng.normal(size=(n, 4, 1)))[..., 0]
    H = A.transpose(0, 2, 1) @ A + 0.01 * np.eye(size)
    lower, upper = -rng.uniform(0.0, 0.5, (n, size)), rng.uniform(0.0, 0.5, (n, size))
    lower[:, 0], upper[:, 0] = -np.inf, np.inf
    steps, C = bounded_step(H, g, lower, upper), np.eye(size)[:, 1:]
    for i in range(n):
        bounds = np.concatenate([lower[i, 1:], -upper[i, 1:]])
        exact = quadprog.solve_qp(H[i], -g[i], np.hstack([C, -C]), bounds)[0]
        np.testing.assert_allclose(steps[i], exact, atol=1e-6)


def test_a_wrong_branch_is_left_for_the_best_path(robot, wanted, rest):
    """From the rest posture, the chosen path of an arm is nowhere far from what is asked."""
    arm, limits = make("arm", robot, wanted), Limits.of(robot)
    path = choose_arm_path(arm, rest, limits, PERIOD)
    np.testing.assert_array_equal(path[0], rest[0])
    fit = PartFit(arm.columns, wanted.length, PERIOD, limits)
    spline = fit.refine(arm, Spline.through(path[:, arm.columns], PERIOD), path, 3)
    assert np.all(np.abs(spline.velocities) <= limits.velocity[arm.columns] + 1e-6)
    y = rest.copy()
    y[:, arm.columns] = spline.knots
    e, _ = arm.evaluate(np.arange(wanted.length), y)
    assert np.degrees(0.05 * np.linalg.norm(e[:, :6], axis=1).mean()) < 3.0


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
    assert np.linalg.norm(ankle - hip) / Build.of(robot).leg == pytest.approx(MAX_LEG_EXTENSION, abs=2e-3)
