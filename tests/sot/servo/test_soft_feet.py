"""Rubber that is too soft to stand on is refused, with the least that would do."""

import re
from dataclasses import replace

import pytest

from sot.errors import InputError
from sot.hardware.compliance import FootCompliance, pendulum_length
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.soft_feet import refuse_soft_feet


@pytest.fixture(scope="module")
def motion() -> Motion:
    return Motion.standing(Robot.load("hrp2"), 1.0, 100.0)


def test_two_feet_share_the_weight_and_one_carries_it_all(motion):
    robot = motion.robot
    least = robot.mass * 9.81 * pendulum_length(robot)
    refuse_soft_feet(FootCompliance(0.51 * least, 0.51 * least), motion)
    with pytest.raises(InputError, match=r"in pitch cannot hold the robot up on 2 feet, from 0\.00 s on") as error:
        refuse_soft_feet(FootCompliance(0.51 * least, 0.49 * least), motion)
    assert float(re.search(r"m g l, (\d+) N", str(error.value))[1]) == pytest.approx(0.5 * least, abs=1.0)

    (phase,) = motion.phases
    alone = replace(phase, start=0.5, feet={"left_foot": phase.feet["left_foot"]})
    hopping = replace(motion, phases=(replace(phase, end=0.5), alone))
    refuse_soft_feet(FootCompliance(1.01 * least, 1.01 * least), hopping)
    with pytest.raises(InputError, match=r"in roll .* on the left foot alone, from 0\.50 s on"):
        refuse_soft_feet(FootCompliance(0.9 * least, 1.1 * least), hopping)
