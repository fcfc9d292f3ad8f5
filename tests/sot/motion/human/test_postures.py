"""Who sits or lies: told, and turned upright; and who only squats."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion import Human, Plan, plan, read, recognise
from sot.motion.human.plausibility import check_plausible
from sot.motion.human.postures import standing
from sot.robots.robot import Robot
from tests.sot.motion.human.clips import Change, changed_groove, lying, on_one_leg, seated
from tests.sot.motion.human.humans import dancer, walker


def danced(tmp_path: Path, change: Change) -> Human:
    path = tmp_path / "clip.bvh"
    path.write_text(changed_groove(change))
    return recognise(read(path))


def planned(human: Human) -> Plan:
    return plan(human.slice(0.0, 1.0), Robot.load("hrp2"), "auto", 200.0)


def test_who_sits_throughout_is_danced_standing_and_told(tmp_path: Path) -> None:
    human = danced(tmp_path, seated)
    (told,) = human.remarks
    assert told.words.startswith("The dancer sits from 0.00 to 1.98 s; the robot stands")
    assert human.points["neck"][:, 2].min() > 0.9  # upright
    found = planned(human)
    assert found.remarks == [told.words]
    assert np.isfinite(found.motion.q).all()
    assert set(found.motion.phases[0].feet) == {"left_foot", "right_foot"}


def test_who_lies_is_turned_upright_and_told(tmp_path: Path) -> None:
    human = danced(tmp_path, lying)
    (told,) = human.remarks
    assert told.words.startswith("The dancer lies from 0.00 to 1.98 s; the robot stands")
    trunk = human.segment_direction("trunk")
    assert trunk[:, 2].min() > 0.99
    feet = [human.points[f"{side}_{joint}"][:, 2] for side in ("left", "right") for joint in ("ankle", "toe")]
    assert np.abs(np.min(feet, axis=0)).max() < 0.02
    assert human.frames["head"][:, 2, 2].min() > 0.8  # level, as far as the dance has it so
    assert planned(human).remarks == [told.words]


def test_who_lies_down_in_between_gets_up_smoothly() -> None:
    human = dancer(8.0)
    fall = np.clip(np.minimum(human.times - 2.0, 6.0 - human.times), 0.0, 1.0)
    angle = 0.5 * np.pi * fall
    turn = np.zeros((human.count, 3, 3))
    turn[:, 0, 0] = turn[:, 2, 2] = np.cos(angle)
    turn[:, 0, 2], turn[:, 2, 0] = -np.sin(angle), np.sin(angle)
    turn[:, 1, 1] = 1.0
    low = np.column_stack([np.zeros((human.count, 2)), 0.1 * fall])
    down = replace(
        human,
        points={name: np.einsum("tij,tj->ti", turn, place) + low for name, place in human.points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )
    up = standing(down)
    (told,) = up.remarks
    assert 2.5 < told.start < 3.5 and 4.5 < told.end < 5.5
    middle = slice(round(3.2 * human.rate), round(4.8 * human.rate))
    assert up.segment_direction("trunk")[middle, 2].min() > 0.95
    np.testing.assert_array_equal(
        up.points["neck"][: round(1.5 * human.rate)], down.points["neck"][: round(1.5 * human.rate)]
    )
    speed = np.linalg.norm(np.diff(up.points["neck"], axis=0), axis=1) * human.rate
    assert speed.max() < 4.0


@pytest.mark.parametrize("lean", [0.0, 0.5])
def test_a_deep_squat_over_the_feet_is_no_seat(lean: float) -> None:
    human = dancer(3.0)
    points = dict(human.points)
    drop = np.array([-0.1, 0.0, -0.42])
    for name in points:
        if not name.endswith(("ankle", "toe")):
            points[name] = points[name] + drop
    for name in ("neck", "chest", "head"):
        points[name] = points[name] + [lean * 0.4, 0.0, -lean * 0.1]
    for side in ("left", "right"):
        points[f"{side}_knee"] = points[f"{side}_ankle"] + [0.26, 0.0, 0.27]
    squat = replace(human, points=points)
    assert standing(squat) is squat


def test_who_stands_on_one_leg_throughout_is_danced_on_one(tmp_path: Path) -> None:
    found = planned(danced(tmp_path, on_one_leg))
    middle = [phase for phase in found.motion.phases if phase.start < 1.5 < phase.end]
    assert [set(phase.feet) for phase in middle] == [{"left_foot"}]


def test_who_stands_on_the_head_is_turned_upright_and_told() -> None:
    human = dancer(3.0)
    turn = np.diag([-1.0, 1.0, -1.0])
    down = replace(
        human,
        points={name: place @ turn.T + [0.0, 0.0, 1.4] for name, place in human.points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )
    up = standing(down)
    assert up.remarks[0].words.startswith("The dancer is upside down from 0.00 to 3.00 s; the robot stands")
    assert up.segment_direction("trunk")[:, 2].min() > 0.99


def test_what_no_body_can_is_refused() -> None:
    human = dancer(3.0)
    far = human.points | {"left_wrist": human.points["left_wrist"] + np.array([4.0, 0.0, 0.0])}
    with pytest.raises(InputError, match=r"its left_wrist is 4\.\d m from its waist at"):
        check_plausible(replace(human, points=far))
    run = np.column_stack([30.0 * human.times, np.zeros((human.count, 2))])
    with pytest.raises(InputError, match=r"its waist moves at 30 m/s"):
        check_plausible(replace(human, points={name: place + run for name, place in human.points.items()}))
    assert check_plausible(human) is human


def posed(drop: float, trunk_tilt: float, wrists: float, move: Callable[[dict[str, np.ndarray]], None]) -> Human:
    """A dancer whose hips are lower, whose trunk leans ahead [rad], and whose wrists are at a height [m]."""
    human = dancer(3.0)
    points = dict(human.points)
    for name in points:
        if not name.endswith(("ankle", "toe", "knee")):
            points[name] = points[name] - [0.0, 0.0, drop]
    c, s = np.cos(trunk_tilt), np.sin(trunk_tilt)
    turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    waist = points["waist"]
    for name in points:
        if not name.endswith(("hip", "knee", "ankle", "toe", "waist")):
            points[name] = waist + (points[name] - waist) @ turn.T
    for side in ("left", "right"):
        points[f"{side}_wrist"] = points[f"{side}_wrist"] * [1.0, 1.0, 0.0] + [0.0, 0.0, wrists]
    move(points)
    return replace(human, points=points, frames={body: turn @ r for body, r in human.frames.items()})


def on_knees(points: dict[str, np.ndarray]) -> None:
    for side in ("left", "right"):
        points[f"{side}_knee"] = points[f"{side}_hip"] - [0.0, 0.0, 0.38]
        points[f"{side}_ankle"] = points[f"{side}_knee"] - [0.37, 0.0, 0.0]
        points[f"{side}_toe"] = points[f"{side}_ankle"] - [0.1, 0.0, 0.05]


@pytest.mark.parametrize(
    ("drop", "tilt", "wrists", "move", "words", "upright"),
    [
        (0.35, 1.5, 0.06, on_knees, "crawls from 0.00 to 3.00 s; the robot stands, its trunk upright", True),
        (0.35, 0.1, 0.6, on_knees, "kneels from 0.00 to 3.00 s; the robot stands, its knees", True),
        (0.1, 1.6, 0.06, lambda points: None, "has a hand on the floor from 0.00 to 3.00 s; the robot stands", False),
        (
            0.1,
            2.5,
            0.06,
            lambda points: None,
            "hangs its head below its hips from 0.00 to 3.00 s; the robot bows",
            None,
        ),
    ],
)
def test_hands_and_knees_on_the_floor_are_told(
    drop: float, tilt: float, wrists: float, move: Callable, words: str, upright: bool | None
) -> None:
    up = standing(posed(drop, tilt, wrists, move))
    assert [one.words.startswith(f"The dancer {words}") for one in up.remarks] == [True]
    trunk = up.segment_direction("trunk")[:, 2]
    least, most = {True: (0.9, 1.0), False: (-1.0, 0.0), None: (0.4, 0.6)}[upright]
    assert least < trunk.min() and trunk.max() <= most


def lifted(human: Human, lift: np.ndarray) -> Human:
    return replace(human, points={name: place + np.outer(lift, [0, 0, 1]) for name, place in human.points.items()})


def test_who_floats_is_told_and_put_on_the_floor() -> None:
    human = dancer(6.0)
    up = lifted(human, 0.3 * np.clip(np.minimum(human.times - 1.5, 4.5 - human.times) / 0.3, 0.0, 1.0))
    swing = 0.3 * np.sin(8.0 * human.times)[:, None] * [1.0, 0.0, 0.0]  # feet that stand on nothing
    up = replace(up, points={name: place + swing for name, place in up.points.items()})
    found = standing(up)
    (told,) = found.remarks
    assert told.words.startswith("Both feet are off the floor, and the body rises by 0.")
    assert 1.5 < told.start < 1.7 and 4.3 < told.end < 4.5 and not told.on_feet
    middle = slice(round(2.5 * human.rate), round(3.5 * human.rate))
    assert np.abs(found.points["left_toe"][middle, 2] - human.points["left_toe"][middle, 2]).max() < 0.05


@pytest.mark.parametrize("seconds", [0.3, 0.5, 0.7])
def test_a_leap_as_high_as_gravity_has_it_is_none(seconds: float) -> None:
    human = dancer(4.0)
    t = np.clip(human.times - 2.0, 0.0, seconds)
    leap = lifted(human, 0.5 * GRAVITY * t * (seconds - t))
    assert leap.points["waist"][:, 2].max() - human.points["waist"][:, 2].max() > 0.05
    assert standing(leap) is leap


def test_who_climbs_is_told_and_steps_on_the_floor() -> None:
    human = walker(steps=6, stride=0.0)
    height = np.zeros(human.count)
    points = {name: place.copy() for name, place in human.points.items()}
    for k in range(6):
        start = 0.8 * (k + 0.5)
        rise = 0.25 * np.clip((human.times - start) / 0.5, 0.0, 1.0)
        height += rise
        side = "left" if k % 2 == 0 else "right"
        for joint in ("ankle", "toe"):
            points[f"{side}_{joint}"][:, 2] += 2.0 * rise if k else rise
    for name in points:
        if not name.endswith(("ankle", "toe")):
            points[name][:, 2] += height
    up = standing(replace(human, points=points))
    assert "m above the floor, as who climbs does, from" in up.remarks[-1].words
    assert min(up.points[f"{side}_toe"][-1, 2] for side in ("left", "right")) < 0.15


def test_who_stands_on_one_leg_all_the_time_is_told(tmp_path: Path) -> None:
    (told,) = danced(tmp_path, on_one_leg).remarks
    assert told.words == "The dancer stands on the left leg from 0.00 to 1.98 s; the robot does where it steps."
