"""Heels rise where a leg would not reach the foot that it leaves, and only as far as it must."""

from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.feet.contacts import bearing_soles, support_polygon
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.heel_rise import MAX_ANGLE, HeelRise, Toes, heel_rises
from sot.motion.feet.support import supports
from sot.motion.feet.swing import contact_phases, feet_at_rest, foot_paths
from sot.robots.leg_range import MAX_EXTENSION
from sot.robots.robot import Robot, shipped_robot_names

LEFT, RIGHT = "left_foot", "right_foot"
TIMES = np.arange(0.0, 4.0, 0.02)


@pytest.fixture(scope="module", params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


@pytest.fixture(scope="module")
def reach(robot):
    return LegReach.of(robot)


def striding(reach, length):
    """Footholds and steps of strides of some leg lengths, and hips that travel along at 0.96 of a leg's height."""
    leg, side = reach.leg_length, 0.5 * reach.hip_width
    half = 0.5 * length * leg
    stands = {
        LEFT: [Foothold(x * half, side, 0.0) for x in (0.0, 1.0, 3.0)],
        RIGHT: [Foothold(x * half, -side, 0.0) for x in (0.0, 2.0, 3.0)],
    }
    steps = [Step(LEFT, 1.0, 1.5), Step(RIGHT, 1.7, 2.2), Step(LEFT, 2.4, 2.9), Step(RIGHT, 3.1, 3.6)]
    x = np.interp(TIMES, [0.8, 3.4], [0.0, 3.0 * half])
    return stands, steps, np.column_stack([x, np.zeros(len(x)), np.full(len(x), 0.96 * leg)])


def rises_of(robot, reach, length):
    stands, steps, hips = striding(reach, length)
    hips[:, 2] += Toes.of(robot, LEFT).height
    return stands, steps, hips, heel_rises(robot, stands, steps, hips, np.zeros(len(TIMES)), TIMES, reach)


def test_the_ankle_turns_about_the_toes(robot):
    rest, foot = feet_at_rest(robot)[LEFT], Toes.of(robot, LEFT)
    assert foot.ahead > 0.0 and foot.height > 0.0
    corners = np.array([rest.act(corner) for corner in robot.sole(LEFT)])
    assert corners[:, 0].max() == pytest.approx(foot.ahead, abs=1e-6)
    toes, ankle = np.array([foot.ahead, 0.0, 0.0]), np.array([0.0, 0.0, foot.height])
    for angle in (0.1, 0.5):
        turned = toes + pin.utils.rotate("y", angle) @ (ankle - toes)
        np.testing.assert_allclose(foot.ankle_shift(np.array([angle]))[0], (turned - ankle)[[0, 2]], atol=1e-12)


def test_short_strides_need_no_heel_and_long_ones_need_much(robot, reach):
    *_, few = rises_of(robot, reach, 0.2)
    *_, many = rises_of(robot, reach, 0.9)
    assert not any(few)
    assert sum(rise is not None for rise in many[1:]) == 3
    assert all(0.05 < rise.angle <= MAX_ANGLE for rise in many if rise)


def test_a_heel_rises_as_far_as_the_leg_needs(robot, reach):
    stands, steps, hips, rises = rises_of(robot, reach, 0.75)
    foot = Toes.of(robot, RIGHT)
    step, rise, here = steps[1], rises[1], stands[RIGHT][0]
    assert rise is not None
    rows = (rise.start < TIMES) & (rise.top > TIMES) & (rise.profile(TIMES) > 0.15)

    def farthest(angle):
        shift = foot.ankle_shift(angle * rise.profile(TIMES[rows]))
        ankle = np.column_stack([here.x + shift[:, 0], np.full(rows.sum(), here.y), foot.height + shift[:, 1]])
        return np.linalg.norm(hips[rows] + [0.0, -0.5 * reach.hip_width, 0.0] - ankle, axis=1).max()

    assert step.lift < rise.top < rise.flat < step.land
    assert farthest(0.0) > MAX_EXTENSION * reach.leg_length
    assert farthest(rise.angle) < farthest(0.0)
    assert farthest(rise.angle) < 1.003 * MAX_EXTENSION * reach.leg_length or rise.angle < MAX_ANGLE


def test_no_heel_rises_before_the_other_foot_carries(robot, reach):
    _, steps, _, rises = rises_of(robot, reach, 0.9)
    for (before, _), (step, rise) in pairwise(zip(steps, rises, strict=True)):
        assert rise is not None and before.land < rise.start < step.lift


def test_the_toes_stay_where_they_are_until_the_foot_leaves(robot, reach):
    stands, steps, _, rises = rises_of(robot, reach, 0.8)
    paths = foot_paths(robot, stands, steps, [0.1] * 4, reach, TIMES, rises)
    path, rest = paths[RIGHT], feet_at_rest(robot)[RIGHT]
    toes = rest.inverse().act(np.array([Toes.of(robot, RIGHT).ahead, 0.0, 0.0]))
    places = path.position + path.rotation @ toes
    rising = (rises[1].start < TIMES) & (steps[1].lift >= TIMES)
    np.testing.assert_allclose(places[rising] - places[0], 0.0, atol=1e-9)
    assert path.position[rising, 2].max() > path.position[0, 2] + 0.005
    corners = path.position[:, None] + np.einsum("tij,cj->tci", path.rotation, robot.sole(RIGHT))
    assert corners[:, :, 2].min() > -1e-6
    landed = steps[1].land <= TIMES
    np.testing.assert_allclose(path.rotation[landed][0], path.rotation[0], atol=1e-9)


def test_a_foot_whose_heel_rises_carries_at_its_front_edge_only(robot, reach):
    stands, steps, _, rises = rises_of(robot, reach, 0.8)
    phases = contact_phases(robot, stands, steps, 4.0, rises)
    (phase, *_) = [phase for phase in phases if phase.rising == (RIGHT,)]
    assert (phase.start, phase.end) == (rises[1].start, steps[1].lift)
    heel = phase.feet[RIGHT].act(robot.sole(RIGHT)[robot.sole(RIGHT)[:, 0].argmin()])[:2]
    toe = phase.feet[RIGHT].act(robot.sole(RIGHT)[robot.sole(RIGHT)[:, 0].argmax()])[:2]
    polygon = support_polygon(robot, phase)
    assert polygon.margin(heel[None])[0] < -0.02 and polygon.margin(toe[None])[0] > -1e-9
    assert len(bearing_soles(robot.soles, phase)[RIGHT]) < len(robot.sole(RIGHT))
    during = [one for one in supports(robot, phases) if phase.start <= one.start < phase.end - 0.041]
    assert during and all(one.polygon.margin(heel[None])[0] < -0.02 for one in during)


def test_a_rise_begins_and_ends_at_rest():
    rise, times = HeelRise(1.0, 1.3, 1.6, 0.4), np.linspace(0.9, 1.7, 8001)
    angles = rise.angles(times)
    rate = np.gradient(angles, times)
    assert angles.max() == pytest.approx(0.4) and angles[0] == angles[-1] == 0.0
    assert np.abs(rate[[1000, 4000, 7000]]).max() < 1e-3
