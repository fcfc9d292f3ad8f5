"""Footholds laid onto treads: soles wholly on them, the human's rises where there are any, and told where not."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion.feet.climbing.terrain import EDGE_MARGIN, Terrain
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.swing import Swing, feet_at_rest, foot_pose, swing_track
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface

HALF_WIDTH = 0.092


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def block(name: str, start: float, end: float, height: float) -> Surface:
    x, y = 0.5 * (end - start), 0.6
    place = pin.SE3(np.eye(3), np.array([0.5 * (start + end), 0.0, height]))
    return Surface(name, np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]]), place)


STAIRS = [block("first", 0.16, 0.46, 0.1), block("second", 0.46, 0.76, 0.2), block("third", 0.76, 1.06, 0.1)]


def climbing(rises: list[float], way: float, heading: float = 0.0):
    """Footholds and levels of who goes ahead by a way at each rise, left foot first, the right one beside it."""
    stands = {foot: [Foothold(0.0, y, heading)] for foot, y in (("left_foot", HALF_WIDTH), ("right_foot", -HALF_WIDTH))}
    levels, steps = {foot: [0.0] for foot in stands}, []
    for k, rise in enumerate(rises):
        for number, foot in enumerate(stands):
            begin = 2.0 * k + number
            steps.append(Step(foot, begin + 0.2, begin + 0.8))
            last = stands[foot][-1]
            stands[foot].append(replace(last, x=last.x + way))
            levels[foot].append(levels[foot][-1] + rise)
    return stands, steps, levels


@pytest.mark.parametrize("way", [0.18, 0.3, 0.36])
@pytest.mark.parametrize("heading", [0.0, 0.2])
def test_soles_stand_wholly_on_treads_that_are_not_the_humans(robot: Robot, way: float, heading: float) -> None:
    reach, asked = LegReach.of(robot), climbing([0.12, 0.08, -0.1, -0.1], way, heading)
    found, missing = Terrain(STAIRS, reach).laid(*asked)
    assert not missing
    margin = EDGE_MARGIN * reach.leg_length - 1e-6
    for foot, own in found.items():
        assert [one.surface for one in own] == [FLOOR, *STAIRS, FLOOR]
        for one in own:
            pose = foot_pose(one, feet_at_rest(robot)[foot])
            corners = np.array([pose.act(corner) for corner in robot.sole(foot)])
            np.testing.assert_allclose(corners[:, 2], one.surface.axes.translation[2], atol=1e-9)
            assert one.surface.edge_margins(corners).min() > margin
        last = np.array([foot_pose(own[-1], feet_at_rest(robot)[foot]).act(c) for c in robot.sole(foot)])
        assert last[:, 0].min() > 1.06 + margin
        assert all(abs(one.y - own[0].y) < 1e-9 for one in own)


@pytest.mark.parametrize("slope", [0.1, 0.2])
def test_soles_lie_flat_on_a_ramp_wholly_on_its_parts(robot: Robot, slope: float) -> None:
    reach, rise = LegReach.of(robot), 0.3 * np.tan(slope)
    parts = [ramp("up", 0.16, 0.0, slope), ramp("over", 0.46, rise, 0.0), ramp("down", 0.76, rise, -slope)]
    found, missing = Terrain(parts, reach).laid(*climbing([0.5 * rise, 0.5 * rise, -0.5 * rise, -0.5 * rise], 0.3))
    assert not missing
    for foot, own in found.items():
        assert [one.surface for one in own] == [FLOOR, *parts, FLOOR]
        for one in own:
            pose = foot_pose(one, feet_at_rest(robot)[foot])
            corners = np.array([pose.act(corner) for corner in robot.sole(foot)])
            np.testing.assert_allclose(corners[:, 2], one.surface.height_at(corners[:, :2]), atol=1e-9)
            assert one.surface.edge_margins(corners).min() > EDGE_MARGIN * reach.leg_length - 1e-3
        assert own[1].passed == pytest.approx(own[1].height + slope * 0.15, abs=0.06 * slope)


def ramp(name: str, start: float, height: float, slope: float) -> Surface:
    """A surface of 0.3 m along x that begins at a height and slopes upward."""
    x, y = 0.15 / np.cos(slope), 0.6
    place = pin.SE3(pin.utils.rotate("y", -slope), np.array([start + 0.15, 0.0, height + 0.15 * np.tan(slope)]))
    return Surface(name, np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]]), place)


def test_treads_that_fit_take_the_footholds_as_they_are(robot: Robot) -> None:
    stands, steps, levels = climbing([0.1, 0.1, -0.1, -0.1], 0.3)
    found, _ = Terrain(STAIRS, LegReach.of(robot)).laid(stands, steps, levels)
    for foot, own in found.items():
        np.testing.assert_allclose([one.x for one in own], [one.x for one in stands[foot]], atol=1e-9)


def test_a_rise_that_the_scene_has_not_is_told_and_the_foot_stays_level(robot: Robot) -> None:
    found, missing = Terrain(STAIRS, LegReach.of(robot)).laid(*climbing([0.1, 0.1, 0.1, -0.3], 0.2))
    assert [one.rise for one in missing] == pytest.approx([0.1, -0.3])
    assert missing[0].time in (0.8, 2.8, 4.8) and missing[1].time == 6.8  # any of three, and the last one
    for own in found.values():
        heights = [one.height for one in own]
        assert heights[-1] == heights[-2] == max(heights) == pytest.approx(0.2)
        assert np.ptp(np.diff(heights)) == pytest.approx(0.1)


def test_who_walks_on_the_level_does_not_walk_into_a_block(robot: Robot) -> None:
    high = [block("chest of drawers", 0.3, 0.9, 0.5)]
    found, missing = Terrain(high, LegReach.of(robot)).laid(*climbing([0.0, 0.0, 0.0], 0.1))
    assert not missing
    toes = max(robot.sole("left_foot")[:, 0].max() + feet_at_rest(robot)["left_foot"].translation[0], 0.0)
    assert all(one.surface is FLOOR and one.x + toes < 0.3 for own in found.values() for one in own)
    assert found["left_foot"][1].x == pytest.approx(0.1)


def test_a_foot_clears_what_it_steps_over(robot: Robot) -> None:
    """One foot steps from the first tread to the third one, over the second, which is higher."""
    reach = LegReach.of(robot)
    found, missing = Terrain(STAIRS, reach).laid(*foot_over_foot())
    assert not missing
    here, there = found["left_foot"][1:3]
    assert (here.surface, there.surface) == (STAIRS[0], STAIRS[2]) and here.passed == pytest.approx(0.1)
    assert there.passed == pytest.approx(0.2)
    beside = found["right_foot"][1]
    track = swing_track(
        Swing(Step("left_foot", 0.0, 1.0), here, there, beside, 0.05), np.linspace(0.0, 1.0, 101), reach
    )
    poses = [foot_pose(Foothold(x, y, yaw), feet_at_rest(robot)["left_foot"]) for x, y, _, yaw in track]
    soles = np.array([[pose.act(corner)[:2] for corner in robot.sole("left_foot")] for pose in poses])
    over = (soles[:, :, 0].max(axis=1) > 0.46) & (soles[:, :, 0].min(axis=1) < 0.76)
    assert track[over, 2].min() > 0.2 and over.sum() > 20


def foot_over_foot():
    """Footholds and levels of who has one foot on each of the treads: left, right, left, right, left."""
    stands = {"left_foot": [0.0, 0.3, 0.9, 1.2], "right_foot": [0.0, 0.6, 1.2]}
    levels = {"left_foot": [0.0, 0.1, 0.1, 0.0], "right_foot": [0.0, 0.2, 0.0]}
    places = {"left_foot": HALF_WIDTH, "right_foot": -HALF_WIDTH}
    steps = [Step(foot, k + 0.2, k + 0.8) for k, foot in enumerate([*list(stands) * 2, "left_foot"])]
    return {foot: [Foothold(x, places[foot], 0.0) for x in own] for foot, own in stands.items()}, steps, levels


def test_what_is_no_tread_is_refused(robot: Robot) -> None:
    tilted = Surface("ramp", STAIRS[0].corners, pin.SE3(pin.utils.rotate("y", 0.4), np.zeros(3)))
    moving = replace(STAIRS[0], point="lid")
    for wrong in (tilted, moving, FLOOR):
        with pytest.raises(InputError, match="is no tread"):
            Terrain([wrong], LegReach.of(robot))
