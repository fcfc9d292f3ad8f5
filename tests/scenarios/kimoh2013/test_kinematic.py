"""A position-controlled robot: Kim & Oh's Table 1 by task corrections and by the cascade, without dynamics."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from scenarios.kimoh2013.imitation import narrowed_joints
from scenarios.kimoh2013.kinematic import assemble_levels, follow_tasks
from solvers import Cascade, TaskCorrection
from sot.control.pose import Pose
from sot.control.tick import Tick
from sot.robots.robot import Robot, shipped_robot_names
from tasks import CenterOfMass, JointBounds, OperationalPoint, Posture
from tests.sot.states import standing_state

UPPER = ("chest", "head", "left_arm", "right_arm")
STILL = np.zeros(6)


def table_1(robot, drop=0.0):
    """The rest posture, the waist lower by a distance [m], reached smoothly within a second."""
    tick = Tick(robot).update(0.0, robot.rest, np.zeros(robot.nv))
    waist, upper = tick.frame("waist"), [robot.joints[k] for group in UPPER for k in robot.groups[group]]
    place, turn = waist.position.copy(), waist.rotation.copy()

    def pose(t):
        x = min(t, 1.0)
        down = drop * np.array([0.0, 0.0, -(x**3) * (10.0 - 15.0 * x + 6.0 * x**2)])
        speed, push = STILL.copy(), STILL.copy()
        speed[2] = -drop * 30.0 * x**2 * (1.0 - x) ** 2
        push[2] = -drop * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x)
        return Pose(place + down, turn, speed, push)

    def standing(foot):
        frame = tick.frame(foot)
        return OperationalPoint(robot, foot, pin.SE3(frame.rotation.copy(), frame.position.copy()))

    return [
        ("feet", [standing(foot) for foot in robot.feet]),
        ("com", [CenterOfMass(tick.com.copy(), axes="xy")]),
        ("attitude", [OperationalPoint(robot, "waist", pose, axes="RPY")]),
        ("height", [OperationalPoint(robot, "waist", pose, axes="z")]),
        ("upper body", [Posture(robot, robot.rest[7:].copy(), upper)]),
    ]


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def test_has_as_many_rows_as_the_robot_has_freedoms(robot):
    tick = Tick(robot).update(0.0, robot.rest, np.zeros(robot.nv))
    levels = assemble_levels(tick, [JointBounds(robot)], table_1(robot))
    assert [len(level.b) for level in levels] == [0, 12, 2, 3, 1, 18]
    assert len(levels[0].lower) == robot.na


def test_cascade_and_corrections_agree_on_every_tick_where_no_bound_is_active(robot):
    rng = np.random.default_rng(0)
    solvers, table, limits, compared = (TaskCorrection(), Cascade()), table_1(robot), [JointBounds(robot)], 0
    for _ in range(40):
        tick = Tick(robot).update(0.0, *standing_state(robot, rng, speed=0.2))
        levels = assemble_levels(tick, limits, table)
        mine, other = (solver.solve(levels) for solver in solvers)
        if not other.levels[0].active.any():
            np.testing.assert_allclose(mine.x, other.x, atol=1e-6)
            compared += 1
    assert compared > 20


@pytest.mark.parametrize("solver", [TaskCorrection, Cascade])
def test_follows_without_drift_and_keeps_what_is_above_a_narrowed_knee(robot, solver):
    free = follow_tasks(robot, robot.rest, [JointBounds(robot)], table_1(robot, 0.03), solver(), 0.005, 1.2)
    assert free.slack[:, 1:].max() < 1e-6 and not free.qps.any()
    np.testing.assert_allclose(free.q[-1, 2] - robot.rest[2], -0.03, atol=1e-4)

    knee = narrowed_joints(robot)[0]
    limit = robot.rest[7 + knee] + 0.5 * (free.q[-1, 7 + knee] - robot.rest[7 + knee])
    upper = robot.upper.copy()
    upper[knee] = limit

    limits = [JointBounds(replace(robot, upper=upper), range_margin=0.0)]
    course = follow_tasks(robot, robot.rest, limits, table_1(robot, 0.03), solver(), 0.005, 1.2)
    assert course.q[:, 7 + knee].max() < limit + 1e-6
    assert course.slack[:, 1:3].max() < 1e-5  # feet and centre of mass
    assert course.slack[:, 4:].max() > 0.1
    if solver is TaskCorrection:
        assert course.qps.max() == 1


@pytest.mark.parametrize("name", shipped_robot_names())
def test_finds_knee_and_hip_roll(name):
    robot = Robot.load(name)
    assert [robot.joints[joint] for joint in narrowed_joints(robot)] == ["LLEG3", "LLEG1"]
