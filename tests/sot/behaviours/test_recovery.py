"""Steps are made when balance needs them, to where they help, and never otherwise."""

import numpy as np
import pinocchio as pin
import pytest

from sot.behaviours.capture import Capture
from sot.behaviours.planned_swing import EarlyLanding
from sot.behaviours.recovery import DISTURBED_DCM_ERROR, HOMEWARD_LENGTH, RecoverySchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.motion.feet.footholds import SOLE_CLEARANCE, LegReach
from sot.polygon import Polygon
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from tests.sim.runs import still_motion
from tests.sot.behaviours.stepping import FIRST, SWING, stepping_motion

PERIOD = 0.005
STEPS_FIRST = "right_foot"


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def motion(robot):
    return still_motion(robot, 2.0)


def standing(robot) -> Stack:
    return Stack([Contact(robot.surface(foot)) for foot in robot.feet], [], {})


def moving(robot, stack, velocity, t: float = 0.0) -> Tick:
    """A robot at rest posture that moves as a whole at a velocity (2,) [m/s]."""
    tick, v = Tick(robot), np.zeros(robot.nv)
    v[:2] = velocity
    tick.contacts = stack.contacts
    return tick.update(t, robot.rest, v)


def reacts(robot, motion, velocity, left: float = 0.5) -> tuple[Stack, list[str]]:
    """What happens to a stack of a robot that moves, and stands with that share of its weight on its left foot."""
    recovery, stack = RecoverySchedule.of(motion), standing(robot)
    loads = dict(zip(robot.feet, robot.mass * GRAVITY * np.array([left, 1.0 - left]), strict=True))
    done = recovery.apply(0.0, stack, loads)
    recovery.observe(moving(robot, stack, velocity))
    return stack, done + recovery.apply(PERIOD, stack, loads)


def ways(stack) -> dict:
    return {contact.point: contact.path for contact in stack.contacts if contact.path is not None}


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (0.2, 0.0), (0.0, 0.3), (-0.1, -0.1)])
def test_what_the_feet_can_hold_makes_no_step(robot, motion, velocity):
    stack, done = reacts(robot, motion, velocity)
    assert done == [] and not ways(stack)


def test_a_robot_is_disturbed_until_it_is_calm_and_while_a_foot_is_astray(robot, motion):
    recovery, stack = RecoverySchedule.of(motion), standing(robot)
    rate = np.sqrt(GRAVITY / moving(robot, stack, (0.0, 0.0)).com[2])
    for share, was, now in ((0.8, False, False), (0.8, True, True), (0.3, True, False), (1.2, False, True)):
        speed = share * DISTURBED_DCM_ERROR * leg_length(robot) * rate
        assert recovery.is_disturbed(moving(robot, stack, (speed, 0.0)), was) == now
    for apart, astray in ((0.0, False), (0.2, True)):
        q, tick = robot.rest.copy(), Tick(robot)
        for side, outward in (("left", 1.0), ("right", -1.0)):
            q[7 + robot.groups[f"{side}_leg"][1]] += outward * apart
        tick.contacts = stack.contacts
        recovery = RecoverySchedule.of(motion)
        tick.update(0.0, q, np.zeros(robot.nv))
        assert np.linalg.norm(recovery._capture.dcm_and_deviation(tick)[1]) < 0.2 * DISTURBED_DCM_ERROR * leg_length(
            robot
        )
        assert recovery.is_disturbed(tick) == astray


@pytest.mark.parametrize("heading", np.deg2rad([-20.0, 0.0, 15.0, 165.0, 190.0]))
def test_a_step_leaves_what_diverges_inside_the_new_support(robot, motion, heading):
    velocity = 0.65 * np.array([np.cos(heading), np.sin(heading)])
    stack, done = reacts(robot, motion, velocity)
    ((foot, way),) = ways(stack).items()
    assert done == [f"{foot} steps"]
    tick = moving(robot, stack, velocity)
    soles = {
        name: (tick.frame(name).position + robot.sole(name) @ tick.frame(name).rotation.T)[:, :2] for name in robot.feet
    }
    moved = way.landing_place - tick.frame(foot).position[:2]
    assert moved @ velocity > 0.0
    rate = np.sqrt(GRAVITY / tick.com[2])
    xi = tick.com[:2] + tick.com_velocity[:2] / rate
    assert Polygon.hull(np.vstack(list(soles.values()))).margin(xi) < 0.0
    alone = Polygon.hull(next(sole for name, sole in soles.items() if name != foot))
    z = alone.inset(0.01).nearest_point(xi)
    xi = z + np.exp(rate * (way.land - PERIOD + 0.04)) * (xi - z)  # when the foot carries
    soles[foot] += moved
    assert Polygon.hull(np.vstack(list(soles.values()))).margin(xi) > 0.02


def test_the_foot_that_steps_is_one_that_the_other_lets_go(robot, motion):
    for left, foot in ((0.9, "right_foot"), (0.1, "left_foot")):
        stack, _ = reacts(robot, motion, (0.6, 0.0), left)
        assert set(ways(stack)) == {foot}


def test_legs_neither_cross_nor_reach_too_far(robot, motion):
    reach, steps = LegReach.of(robot), 0
    clearance = SOLE_CLEARANCE * reach.leg_length
    width = robot.sole("right_foot")[:, 1].max() - robot.sole("left_foot")[:, 1].min()  # of the inner halves
    for heading in np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False):
        for speed in (0.6, 0.9):
            stack, _ = reacts(robot, motion, speed * np.array([np.cos(heading), np.sin(heading)]))
            for foot, way in ways(stack).items():
                beside, side = ("right_foot", 1.0) if foot == "left_foot" else ("left_foot", -1.0)
                off = way.landing_place - moving(robot, stack, (0.0, 0.0)).frame(beside).position[:2]
                assert side * off[1] > width + clearance - 1e-6
                assert (
                    np.linalg.norm(off - (0.0, side * max(reach.hip_width, width + clearance)))
                    < reach.max_stride + 1e-6
                )
                steps += 1
    assert steps > 10


def test_the_place_follows_until_shortly_before_the_foot_lands(robot, motion):
    recovery, stack = RecoverySchedule.of(motion), standing(robot)
    loads = dict.fromkeys(robot.feet, 0.5 * robot.mass * GRAVITY)
    recovery.apply(0.0, stack, loads)
    recovery.observe(moving(robot, stack, (0.6, 0.0)))
    recovery.apply(PERIOD, stack, loads)
    ((foot, way),) = ways(stack).items()
    first = way.landing_place[0]
    recovery.observe(moving(robot, stack, (0.75, 0.0), t=0.1))
    assert way.landing_place[0] > first + 0.02
    second = way.landing_place[0]
    recovery.observe(moving(robot, stack, (0.9, 0.0), t=way.land - 0.05))
    assert way.landing_place[0] == second
    for t in np.arange(2 * PERIOD, way.land + 0.2, PERIOD):
        recovery.apply(t, stack, loads if stack.contact(foot).mode == "fixed" else loads | {foot: 0.0})
    assert stack.contact(foot).mode == "fixed" and not ways(stack)


def test_between_steps_of_the_plan_only_where_it_leaves_time(robot):
    motion = stepping_motion(robot, rate=200.0)
    for t, steps in ((0.0, 1), (FIRST - 0.5, 0)):
        recovery, stack = RecoverySchedule.of(motion), standing(robot)
        loads = dict.fromkeys(robot.feet, 0.5 * robot.mass * GRAVITY)
        recovery.apply(t, stack, loads)
        recovery.observe(moving(robot, stack, (0.65, 0.0), t))
        recovery.apply(t + PERIOD, stack, loads)
        assert len(ways(stack)) == steps


def swinging(robot, motion, velocity, shift, times) -> tuple[Stack, RecoverySchedule]:
    """A robot that is where the motion has it at some times, but shifted (2,) [m], and faster by a velocity (2,)."""
    recovery, stack = RecoverySchedule.of(motion), standing(robot)
    weight = robot.mass * GRAVITY
    for t in times:
        swings = FIRST < t < FIRST + SWING
        loads = {foot: weight if foot != STEPS_FIRST else 0.0 if swings else 0.5 * weight for foot in robot.feet}
        recovery.apply(t, stack, loads)
        now, tick = motion.sample(t), Tick(robot)
        q, v = now.q.copy(), now.v.copy()
        q[:2] += shift
        v[:3] += pin.Quaternion(q[3:7]).matrix().T @ (*velocity, 0.0)
        tick.contacts = stack.contacts
        recovery.observe(tick.update(t, q, v))
    return stack, recovery


UP_TO = np.arange(FIRST - 0.1, FIRST + 0.3, PERIOD)


@pytest.mark.parametrize("off", [(0.0, 0.08), (0.1, 0.08), (0.7, 0.0)])
def test_a_place_that_the_plan_has_chosen_is_in_reach(robot, motion, off):
    left, right = robot.feet
    tick, capture = moving(robot, standing(robot), (0.0, 0.0)), Capture(robot, motion)
    planned = tick.frame(right).position[:2] + off
    assert np.linalg.norm(capture.reachable_place(tick, planned, right, left) - planned) > 0.01
    np.testing.assert_allclose(capture.reachable_place(tick, planned, right, left, planned), planned, atol=1e-9)


def test_a_planned_swing_is_as_planned_without_a_disturbance(robot):
    motion = stepping_motion(robot, rate=200.0)
    stack, _ = swinging(robot, motion, (0.05, 0.0), (0.01, 0.0), UP_TO)
    assert stack.contact(STEPS_FIRST).mode == "off" and not ways(stack)


@pytest.mark.parametrize("velocity", [(0.4, 0.0), (-0.4, 0.0), (0.0, -0.35)])
def test_a_planned_swing_lands_off_its_place_by_what_will_be_off_the_plan(robot, velocity):
    motion = stepping_motion(robot, rate=200.0)
    stack, _ = swinging(robot, motion, velocity, (0.0, 0.0), UP_TO)
    ((foot, way),) = ways(stack).items()
    assert foot == STEPS_FIRST
    off = way(way.land).position[:2] - way.planned[:2]
    np.testing.assert_allclose(off, way.landing_off, atol=1e-9)
    assert off @ velocity > 0.02 * np.linalg.norm(velocity)


def test_where_it_cannot_wait_the_foot_lands_early_and_stands_for_its_planned_place(robot):
    motion = stepping_motion(robot, rate=200.0)
    land, weight = FIRST + SWING, robot.mass * GRAVITY
    stack, recovery = swinging(robot, motion, (0.0, -0.35), (0.0, 0.0), UP_TO)
    way = stack.contact(STEPS_FIRST).path
    assert isinstance(way, EarlyLanding) and UP_TO[-1] < way.land < land - 0.05
    for t in np.arange(UP_TO[-1] + PERIOD, way.land + 0.01, PERIOD):
        recovery.apply(t, stack, {foot: weight * (foot != STEPS_FIRST or t > way.land) for foot in robot.feet})
    contact = stack.contact(STEPS_FIRST)
    assert contact.mode == "fixed" and contact.path is None
    np.testing.assert_allclose(contact.foothold, motion.pose(STEPS_FIRST)(land).position, atol=2e-3)


def test_feet_that_stand_elsewhere_come_home_by_a_little_with_each_step(robot):
    motion = stepping_motion(robot, rate=200.0)
    stack, _ = swinging(robot, motion, (0.0, 0.0), (0.1, 0.0), UP_TO)
    ((_, way),) = ways(stack).items()
    np.testing.assert_allclose(way.landing_off, (0.1 - HOMEWARD_LENGTH * leg_length(robot), 0.0), atol=3e-3)
    lift = way(FIRST + PERIOD)
    planned = motion.pose(STEPS_FIRST)(FIRST + PERIOD)
    np.testing.assert_allclose(lift.position[:2] - planned.position[:2], (0.1, 0.0), atol=2e-3)
