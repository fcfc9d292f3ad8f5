"""Slides are found where the ZMP lies in one foot, and their ways lead from rest to rest on the floor."""

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.slides import REST_TIME, Slide, find_slide, paths_with_slides, phases_with_slides, slide_duration
from sot.motion.feet.support import ZMP_INSET_SLIDING, supports
from sot.motion.feet.swing import standing_paths
from sot.robots.robot import Robot, shipped_robot_names
from sot.robots.size import leg_length

RATE = 50.0
SECONDS = 40.0
WAY = (0.08, 0.02, 0.1)


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


@pytest.fixture
def phases(robot):
    return planted_phases(robot, SECONDS)


def leaning(phases, *parts):
    """A ZMP between the feet, but for parts (foot, from, until, share of the way to that foot)."""
    left, right = (phases[0].feet[foot].translation[:2] for foot in ("left_foot", "right_foot"))
    times = np.arange(round(SECONDS * RATE) + 1) / RATE
    zmp = np.tile(0.5 * (left + right), (len(times), 1))
    for foot, begin, end, share in parts:
        there = left if foot == "left_foot" else right
        rows = (times >= begin) & (times <= end)
        zmp[rows] += share * (there - zmp[rows])
    return zmp


def test_a_foot_slides_while_the_zmp_lies_in_the_other(robot, phases):
    lasts = slide_duration(WAY, robot)
    zmp = leaning(phases, ("left_foot", 12.0, 12.5 + lasts, 1.0), ("right_foot", 3.0, 3.0 + 0.5 * lasts, 1.0))
    slide = find_slide(robot, phases, zmp, RATE, WAY)
    assert slide.foot == "right_foot" and slide.way == WAY
    assert 12.0 <= slide.start < slide.end <= 12.5 + lasts
    assert slide.end - slide.start == pytest.approx(lasts, abs=1.0 / RATE)
    assert slide.zmp_excess == 0.0


def test_where_it_never_does_the_zmp_has_to_be_moved_the_least(robot, phases):
    lasts = slide_duration(WAY, robot)
    zmp = leaning(phases, ("left_foot", 5.0, 5.0 + lasts, 0.3), ("right_foot", 20.0, 20.0 + lasts, 0.5))
    slide = find_slide(robot, phases, zmp, RATE, WAY)
    assert slide.foot == "left_foot"
    assert slide.start == pytest.approx(20.0, abs=0.2)
    assert 0.0 < slide.zmp_excess < 0.1


def test_a_motion_may_be_too_short(robot):
    with pytest.raises(InputError, match=r"too short for a slide: one takes \d+\.\d s on both feet"):
        find_slide(robot, planted_phases(robot, 5.0), np.zeros((251, 2)), RATE, WAY)


def test_afterwards_the_foot_stands_where_it_has_come_to(robot, phases):
    made = phases_with_slides(phases, [Slide("left_foot", 5.0, 11.0, WAY), Slide("right_foot", 14.0, 20.0, WAY)], robot)
    assert [phase.sliding for phase in made] == [(), ("left_foot",), (), ("right_foot",), ()]
    assert [(phase.start, phase.end) for phase in made] == [
        (0.0, 5.0),
        (5.0, 11.0),
        (11.0, 14.0),
        (14.0, 20.0),
        (20.0, 40.0),
    ]
    assert [len(phase.feet) for phase in made] == [2, 1, 2, 1, 2]
    for foot, side in (("left_foot", 1.0), ("right_foot", -1.0)):
        moved = made[0].feet[foot].inverse() * made[-1].feet[foot]
        turn = pin.log3(made[-1].feet[foot].rotation @ made[0].feet[foot].rotation.T)
        np.testing.assert_allclose(turn, [0.0, 0.0, side * WAY[2]], atol=1e-9)
        assert np.hypot(*moved.translation[:2]) == pytest.approx(np.hypot(*WAY[:2]))
        gone = made[-1].feet[foot].translation - made[0].feet[foot].translation
        np.testing.assert_allclose(gone, [WAY[0], side * WAY[1], 0.0], atol=1e-6)


def test_a_way_leads_from_rest_to_rest(robot, phases):
    slide = Slide("left_foot", 5.0, 11.0, WAY)
    times = np.arange(round(SECONDS * RATE) + 1) / RATE
    paths = paths_with_slides(standing_paths(phases[0], len(times)), [slide], robot, times)
    after = phases_with_slides(phases, [slide], robot)[-1].feet["left_foot"]
    path, other = paths["left_foot"], paths["right_foot"]
    np.testing.assert_allclose(path.position[-1], after.translation, atol=1e-12)
    np.testing.assert_allclose(path.rotation[-1], after.rotation, atol=1e-12)
    assert not np.ptp(path.position[:, 2]) and not np.ptp(other.position, axis=0).any()
    speed = np.linalg.norm(np.diff(path.position, axis=0), axis=1) * RATE
    assert np.all(speed[(times[1:] <= 5.0) | (times[:-1] >= 11.0)] == 0.0)
    assert speed.max() < 1.1 * np.hypot(*WAY[:2]) / (6.0 - 2.0 * REST_TIME)  # even: hops come with speed
    assert np.abs(np.diff(speed)).max() * RATE < 0.1  # no jump in speed


def test_beside_a_slide_the_zmp_is_planned_further_inside(robot, phases):
    made = phases_with_slides(phases, [Slide("left_foot", 5.0, 11.0, WAY)], robot)
    where = supports(robot, made)
    alone = next(support for support in where if 5.0 <= support.start < 11.0 or abs(support.start - 5.0) < 0.1)
    margins = alone.polygon.margin(alone.inset.vertices)
    assert margins.min() >= min(ZMP_INSET_SLIDING) * leg_length(robot) - 1e-9
