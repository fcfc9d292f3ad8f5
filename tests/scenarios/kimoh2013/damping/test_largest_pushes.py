"""The search for the largest push, on robots that are known; a push that only a step catches, under physics."""

from dataclasses import replace
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from scenarios.kimoh2013.damping.largest_pushes import (
    FEET,
    NOTHING,
    STEPS,
    largest_impulse,
    print_largest_pushes,
    stands_after,
)
from scenarios.kimoh2013.damping.push_runs import IMPULSE_STEP, usual_push
from scenarios.kimoh2013.damping.stance import stance_of, usual_compliance
from scenarios.stacks import catching_stack
from sot.control.tick import Tick
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from tasks import JointBounds

GRID = IMPULSE_STEP**0.25


@pytest.mark.parametrize("start", [2.0, 20.0, 50.0])
def test_largest_impulse_of_a_robot_that_falls_from_a_known_one_on(start):
    found = largest_impulse(lambda impulse, seed: impulse < 23.0, start, 3)
    assert 23.0 / GRID <= found < 23.0


def test_all_seeds_have_to_survive():
    found = largest_impulse(lambda impulse, seed: impulse < (19.0 if seed == 2 else 23.0), 10.0, 3)
    assert 19.0 / GRID <= found < 19.0


def test_ratios_are_printed():
    text = StringIO()
    print_largest_pushes({"back": {NOTHING: 10.0, FEET: 11.0, STEPS: 21.0}}, Console(file=text, width=100))
    assert "1.10 x" in text.getvalue() and "2.10 x" in text.getvalue()


def test_legs_of_the_state_that_leads_servos_keep_off_their_stops():
    robot = Robot.load("hrp2")
    stack, period = catching_stack(robot, Motion.standing(robot, 0.1, 200.0)), 0.005
    bounds = next(one for one in stack.hard if isinstance(one, JointBounds))
    tick, q = Tick(robot, period), robot.rest.copy()
    knee, wrist = robot.joints.index("RLEG3"), robot.joints.index("RARM6")
    q[7 + knee], q[7 + wrist] = robot.lower[knee] + 0.04, robot.lower[wrist] + 0.04
    tick.update(0.0, q, np.zeros(robot.nv))
    lower = bounds.rows(tick).lower
    assert lower[knee] > 0.0 > lower[wrist]


@pytest.mark.slow
@pytest.mark.parametrize(("direction", "impulse"), [(1.0, 35.0), (-1.0, 28.5)])
def test_a_step_catches_what_feet_that_stay_do_not(direction, impulse):
    robot = Robot.load("hrp2")
    stance, compliance = stance_of(robot, "double"), usual_compliance(robot)
    push = usual_push(stance, 0, 1)
    push = replace(push, force=(direction * impulse / push.duration, 0.0, 0.0))
    assert not stands_after(stance, compliance, FEET, push, 1)
    assert stands_after(stance, compliance, STEPS, push, 1)
