from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion import Human, Plan, plan, read, recognise
from sot.motion.feet.contacts import Phase, support_polygon
from sot.motion.fitter import BOUNCE_FADE_TIME, PLAN_RATE, hips_without_bounce_in_slides
from sot.motion.likeness import UPPER_SEGMENTS, hand_path_ratio, mean_segment_angle_deg
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import dancer

MOCAP = Path(__file__).parents[4] / "shared" / "mocap"
POINTS = (
    "waist",
    "neck",
    "head",
    "head_top",
    *(
        f"{side}_{joint}"
        for side in ("left", "right")
        for joint in ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")
    ),
)


@pytest.fixture(scope="module", params=["hrp2", "hrp2_modified"])
def robot(request):
    return Robot.load(request.param)


@pytest.fixture(scope="module")
def planned(robot):
    return plan(dancer(), robot, rate=500.0)


def points_of(planned: Plan, human: Human) -> tuple[dict, dict]:
    """Points of the human and of the robot at the same times of the clip."""
    motion = planned.motion
    inside = (motion.times >= planned.start) & (motion.times <= planned.start + human.duration)
    times = motion.times[inside] - planned.start
    ours = {name: motion.track(name).position[inside] for name in POINTS}
    theirs = {
        name: np.column_stack([np.interp(times, human.times, column) for column in human.points[name].T])
        for name in POINTS
    }
    return theirs, ours


def assert_feasible(motion, zmp_margin):
    robot = motion.robot
    assert np.all(motion.q[:, 7:] >= robot.lower) and np.all(motion.q[:, 7:] <= robot.upper)
    assert np.all(np.abs(motion.v[:, 6:]) <= robot.velocity)
    assert np.all(np.abs(motion.a[:, 6:]) <= robot.acceleration)
    for foot in robot.feet:
        track, pose = motion.track(foot), motion.phases[0].feet[foot]
        assert np.abs(track.position - pose.translation).max() < 5e-4
        assert np.abs(track.rotation - pose.rotation).max() < 2e-3
    assert support_polygon(robot, motion.phases[0]).margin(motion.zmp).min() > zmp_margin


def test_motion_is_feasible(planned):
    assert_feasible(planned.motion, zmp_margin=0.02)


def test_zmp_of_the_plan_is_that_of_its_dynamics(planned):
    motion, data = planned.motion, planned.motion.robot.model.createData()
    for k in range(0, len(motion.q), 101):
        pin.forwardKinematics(motion.robot.model, data, motion.q[k])
        wrench = pin.Force(pin.rnea(motion.robot.model, data, motion.q[k], motion.v[k], motion.a[k])[:6])
        floor = data.oMi[1].act(wrench)
        expected = [-floor.angular[1] / floor.linear[2], floor.angular[0] / floor.linear[2]]
        np.testing.assert_allclose(motion.zmp[k], expected, atol=1e-9)


def test_starts_from_the_rest_posture_and_ends_at_rest(planned):
    motion = planned.motion
    np.testing.assert_allclose(motion.q[0], motion.robot.rest, atol=1e-4)
    for end in (0, -1):
        np.testing.assert_allclose(motion.v[end], 0.0, atol=1e-6)
        np.testing.assert_allclose(motion.a[end], 0.0, atol=1e-4)


def test_robot_looks_like_the_human(planned):
    human = dancer()
    theirs, ours = points_of(planned, human)
    assert mean_segment_angle_deg(theirs, ours, UPPER_SEGMENTS) < 5.0
    assert 0.8 < hand_path_ratio(theirs, ours, planned.motion.rate) < 1.2


def test_key_points_are_where_the_segments_point(planned, robot):
    """The dancer is within reach: what is left of its targets is a few degrees of half a metre of arm."""
    assert 0.0 < planned.retarget["key_point_rms_m"] < 0.04


def test_too_fast_a_human_costs_likeness_but_no_limit(robot):
    human = dancer(2.0, speed=3.0)
    planned = plan(human, robot, rate=500.0)
    assert_feasible(planned.motion, zmp_margin=0.0)
    assert np.abs(planned.motion.v[:, 6:] / robot.velocity).max() > 0.9
    assert mean_segment_angle_deg(*points_of(planned, human), UPPER_SEGMENTS) < 25.0


def test_unknown_feet(robot):
    with pytest.raises(InputError, match="choose one of auto, dancer, steps, planted"):
        plan(dancer(), robot, feet="flying")


def test_a_slide_is_put_in_with_the_zmp_in_the_other_foot():
    robot = Robot.load("hrp2")
    motion = plan(dancer(), robot, rate=200.0, slide=(0.015, 0.0, 0.0)).motion
    (phase,) = (phase for phase in motion.phases if phase.sliding)
    (foot,), (standing,) = phase.sliding, phase.feet
    rows = (motion.times >= phase.start) & (motion.times <= phase.end)
    assert support_polygon(robot, phase).margin(motion.zmp[rows]).min() > 0.035
    gone = motion.track(foot).position - motion.phases[0].feet[foot].translation
    assert np.abs(gone[motion.times < phase.start]).max() < 5e-4
    assert np.abs(gone[motion.times > phase.end] - [0.015, 0.0, 0.0]).max() < 5e-4
    assert np.abs(motion.track(standing).position - phase.feet[standing].translation).max() < 5e-4
    assert np.all(motion.q[:, 7:] >= robot.lower) and np.all(motion.q[:, 7:] <= robot.upper)


def test_the_hips_keep_their_bounce_but_for_while_a_foot_slides():
    times = np.arange(600) / PLAN_RATE
    hips = np.column_stack([np.zeros(600), 0.1 * times, 0.8 + 0.02 * np.sin(2.0 * np.pi * 2.0 * times)])
    feet = {"left_foot": pin.SE3.Identity()}
    phases = (Phase(0.0, 4.0, feet), Phase(4.0, 8.0, feet, ("right_foot",)), Phase(8.0, 12.0, feet))
    calm = hips_without_bounce_in_slides(hips, phases)
    away = (times < 4.0 - BOUNCE_FADE_TIME) | (times > 8.0 + BOUNCE_FADE_TIME)
    np.testing.assert_array_equal(calm[away], hips[away])
    np.testing.assert_array_equal(calm[:, :2], hips[:, :2])
    assert np.abs(calm[(times > 4.0) & (times < 8.0), 2] - 0.8).max() < 0.002


def test_slides_that_do_not_fit():
    robot = Robot.load("hrp2")
    with pytest.raises(InputError, match="only planted feet slide"):
        plan(dancer(), robot, feet="steps", slide=(0.03, 0.0, 0.0))
    with pytest.raises(InputError, match="too short for a slide"):
        plan(dancer(), robot, slide=(0.5, 0.0, 0.0))


@pytest.mark.skipif(not MOCAP.is_dir(), reason="needs ../shared/mocap")
def test_punch():
    human = recognise(read(MOCAP / "bandai_punch.bvh"))
    planned = plan(human, Robot.load("hrp2"), rate=500.0)
    assert_feasible(planned.motion, zmp_margin=0.02)
    theirs, ours = points_of(planned, human)
    assert mean_segment_angle_deg(theirs, ours, UPPER_SEGMENTS) < 8.0
    assert 0.8 < hand_path_ratio(theirs, ours, 500.0) < 1.2
