"""A follower whose feet may step, before a person who sways on the spot and one who steps."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.live.follower import REORDERING_TIME
from sot.live.reference import PERIOD
from sot.live.steps.follower import SteppingFollower
from sot.motion.body.coordinates import to_configuration
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk
from tests.sot.live.people import Spoilt

STEP_AT, STEP_TIME, STEP = 1.6, 0.5, np.array([0.3, 0.0, 0.0])
DURATION = 3.0


def stepping(frame, now):
    """The dancer, whose left leg steps ahead once, and whose body goes along by half of that."""
    share = (frame.stamp - STEP_AT) / STEP_TIME
    done = float(minimum_jerk(np.array(share)))
    up = 0.12 * np.sin(np.pi * min(max(share, 0.0), 1.0))
    positions = frame.positions + 0.5 * done * STEP
    for joint, name in enumerate(frame.skeleton.joints):
        if name.lower().startswith("left") and any(part in name.lower() for part in ("foot", "toe", "ankle")):
            positions[joint] += 0.5 * done * STEP + [0.0, 0.0, up]
        elif name.lower().startswith("right") and any(part in name.lower() for part in ("foot", "toe", "ankle")):
            positions[joint] -= 0.5 * done * STEP
    return [replace(frame, positions=positions, rotations=None)]


def followed(spoil):
    robot = Robot.load("hrp2")
    follower, begun = SteppingFollower(Spoilt(spoil), robot, 0.5), []
    follower.footing.begun.append(lambda *step: begun.append(step))
    for k in range(round(DURATION / PERIOD)):
        follower.update(k * PERIOD)
    return robot, follower, begun


def test_a_person_who_sways_on_the_spot_makes_no_step_and_the_body_is_where_the_plan_has_it():
    robot, follower, begun = followed(lambda frame, now: [frame])
    assert begun == []
    (phase,) = follower.footing.phases(DURATION)
    data, y = robot.model.createData(), follower.reference.now
    q = to_configuration(y[None])[0]
    pin.framesForwardKinematics(robot.model, data, q)
    for foot, pose in phase.feet.items():
        np.testing.assert_allclose(data.oMf[robot.point(foot)].translation, pose.translation, atol=2e-3)
    com = pin.centerOfMass(robot.model, data, q)
    np.testing.assert_allclose(com[:2], follower.footing.com[0], atol=5e-3)


def test_a_person_who_steps_lets_the_robot_step_as_far_in_its_size():
    _, follower, begun = followed(stepping)
    assert [foot for foot, *_ in begun] == ["left_foot"]
    (_, lift, land), stands = begun[0], follower.footing.stands
    assert lift > STEP_AT + 0.5 - 0.05 and land < STEP_AT + STEP_TIME + 0.5 + 0.4
    ahead = stands["left_foot"].x - stands["right_foot"].x
    assert ahead == pytest.approx(STEP[0] * follower.footing.scale, abs=0.06)


def test_frames_are_known_as_long_before_they_are_due_as_the_delay_lets_them_be():
    delay, known = 0.5, []
    follower = SteppingFollower(Spoilt(lambda frame, now: [frame]), Robot.load("hrp2"), delay)
    for t in PERIOD * np.arange(round(1.6 / PERIOD)):
        follower.update(t)
        known += [follower._moments[-1][0] - t] if follower._moments else []
    assert min(known[-20:]) > delay - REORDERING_TIME - 0.05
