"""Footholds for a person's steps: what a knee has to do for them, and how far it lets a foot go."""

import numpy as np
import pinocchio as pin
import pytest

from sot.behaviours.stride import Stride
from sot.live.steps.knee_speed import MAX_SPEED_SHARE, SAMPLES, KneeSpeed
from sot.live.steps.person_steps import AskedStep
from sot.live.steps.reachable import live_reach
from sot.live.steps.step_place import StepPlace
from sot.live.steps.step_plan import DecidedStep
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.swing import feet_at_rest, foot_pose
from sot.robots.leg_range import Leg
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def com_ahead(robot, lower=0.08, speed=0.0):
    """A body that is lower than at rest, and goes ahead."""
    com = pin.centerOfMass(robot.model, robot.model.createData(), robot.rest).copy()
    return lambda times: com - [0.0, 0.0, lower] + np.outer(times - 1.0, [speed, 0.0, 0.0])


def decided(dx, dy=0.0, span=0.4, foot="left_foot"):
    start = Foothold(0.0, 0.095 if foot == "left_foot" else -0.095, 0.0)
    place, beside = Foothold(dx, start.y + dy, 0.0), Foothold(0.0, -start.y, 0.0)
    asked = AskedStep(foot, 1.0, 1.0 + span, start, place, beside, has_landed=True)
    return DecidedStep(foot, 1.0, 1.0 + span, start, place, asked, place), beside


@pytest.mark.parametrize("foot", ["left_foot", "right_foot"])
@pytest.mark.parametrize("dx, dy", [(0.0, 0.0), (0.3, 0.0), (-0.25, 0.05)])
def test_a_knee_is_as_fast_as_the_leg_under_level_hips_needs(robot, foot, dx, dy):
    step, _ = decided(dx, dy if foot == "left_foot" else -dy, foot=foot)
    rest, leg = feet_at_rest(robot)[foot], Leg(robot, foot.removesuffix("_foot"))
    before, after = (foot_pose(at, rest) for at in (step.start, step.place))
    stride = Stride(before.translation, before.rotation, step.lift, step.land, 0.04)
    stride.redirect(step.lift, after.translation[:2])
    angles, posture = [], leg.rest
    times = np.linspace(step.lift, step.land, SAMPLES)
    for t in np.concatenate([np.full(5, step.lift), times]):
        moved = stride(min(t, step.land)).position - before.translation
        posture = leg.posture(posture, leg.ankle - leg.hip + moved + [0.0, 0.0, 0.08], np.eye(3))
        angles.append(posture[3])
    fastest = np.abs(np.diff(angles[5:])).max() / (times[1] - times[0])
    limit = robot.velocity[robot.groups[f"{foot.removesuffix('_foot')}_leg"][3]]
    found = KneeSpeed(robot)(foot, step.start, step.place, 0.4, 0.04, com_ahead(robot)(times), 0.0)
    assert MAX_SPEED_SHARE * limit * found == pytest.approx(fastest, rel=0.1)


def shortened(robot, dx, span=0.4, speed=0.0):
    """Where a step ends that would go so far, and a robot that decides on it."""
    places = StepPlace(robot, live_reach(robot))
    step, beside = decided(dx, span=span)
    step.place = places(step, beside)
    places.shorten(step, beside, com_ahead(robot, speed=speed))
    assert places(step, beside) == step.place, "it stays so"
    return step.place.x


def test_a_step_is_as_long_as_its_knee_is_fast(robot):
    assert shortened(robot, 0.1) == pytest.approx(0.1)
    behind = shortened(robot, 0.36)
    assert 0.1 < behind < 0.3, "hips that stay behind stretch the leg"
    assert shortened(robot, 0.36, speed=0.5) > behind + 0.03
    assert shortened(robot, 0.36, span=0.7) == pytest.approx(0.36)
