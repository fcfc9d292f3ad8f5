"""The search for the largest push, on robots that are known; a push that only a step catches, under physics."""

from dataclasses import replace
from io import StringIO

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
from sot.robots.robot import Robot

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


@pytest.mark.slow
@pytest.mark.parametrize(("direction", "impulse"), [(1.0, 31.0), (-1.0, 25.0)])
def test_a_step_catches_what_feet_that_stay_do_not(direction, impulse):
    robot = Robot.load("hrp2")
    stance, compliance = stance_of(robot, "double"), usual_compliance(robot)
    push = usual_push(stance, 0, 1)
    push = replace(push, force=(direction * impulse / push.duration, 0.0, 0.0))
    assert not stands_after(stance, compliance, FEET, push, 1)
    assert stands_after(stance, compliance, STEPS, push, 1)
