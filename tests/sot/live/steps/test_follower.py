"""A follower whose feet may step, before a person who sways on the spot and one who steps."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.live.follower import REORDERING_TIME
from sot.live.reference import PERIOD
from sot.live.steps.follower import LEG_RESERVE, PELVIS_TILT_SHARE, TILT, SteppingFollower
from sot.motion.body.coordinates import to_configuration
from sot.motion.body.limits import Limits
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


@pytest.fixture(scope="module")
def swaying():
    return followed(lambda frame, now: [frame])[:2]


def test_a_pelvis_is_asked_for_no_tilt_that_takes_the_legs_to_the_ends_of_their_ranges(swaying):
    robot, follower = swaying
    targets = follower.shown[-1][1]
    roll = pin.utils.rotate("x", 0.6)
    frames = {body: roll @ rotation for body, rotation in targets.frames.items()}
    directions = {segment: roll @ along for segment, along in targets.directions.items()}
    follower._body.put_feet(follower._feet_under(targets.hips))
    y = follower._solution
    for _ in range(10):
        y = follower._body.solve(replace(targets, frames=frames, directions=directions), y)
    legs = list(robot.groups["legs"])
    limits = Limits.of(robot)
    room = np.minimum(y - limits.lower, limits.upper - y)[6:][legs]
    assert y[3] > 0.1 and room.min() == pytest.approx(LEG_RESERVE, abs=1e-3)


def test_the_robot_tilts_its_pelvis_by_a_share_and_turns_it_as_asked(swaying):
    _, follower = swaying
    y = follower._solution.copy()
    y[2:6] = 0.7, 0.3, -0.4, 0.5
    less = follower._tilted_less(y)
    np.testing.assert_allclose(less[TILT], PELVIS_TILT_SHARE * y[TILT])
    np.testing.assert_array_equal(np.delete(less, [3, 4]), np.delete(y, [3, 4]))


def test_legs_are_asked_to_reach_the_feet_from_where_balance_has_the_hips(swaying):
    _, follower = swaying
    y = follower.reference.now
    hips = (y[:3] + pin.rpy.rpyToMatrix(*y[3:6]) @ follower._build.hips)[:2]
    stands = follower.footing.poses(follower.reference.horizon)
    aside = np.array([0.05, -0.08])
    for foot, pose in follower._feet_under(np.append(hips + aside, 0.0)).items():
        np.testing.assert_allclose(pose.position[:2] - stands[foot].position[:2], aside, atol=0.02)
