"""Faults of a tracker: frames that jump, floors that drift; and what looks like one and is none."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sot.motion import Human, read, recognise
from sot.motion.human.mending import on_level_floor, without_jumps
from tests.sot.motion.human.clips import Change, changed_groove, drifting, jumping
from tests.sot.motion.human.humans import dancer, walker


@pytest.fixture(scope="module")
def danced(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Change], Human]:
    def recognised(change: Change) -> Human:
        path = tmp_path_factory.mktemp("clip") / "clip.bvh"
        path.write_text(changed_groove(change))
        return recognise(read(path))

    return recognised


@pytest.fixture(scope="module")
def plain(danced: Callable[[Change], Human]) -> Human:
    return danced(lambda _: None)


def test_a_frame_that_jumps_is_bridged_and_told(danced: Callable[[Change], Human], plain: Human) -> None:
    human = danced(jumping)
    assert [one.words for one in human.remarks] == [
        "The tracker jumps by 3.00 m at 1.00 s and is back after 0.02 s: the recording is bridged there."
    ]
    for name, place in human.points.items():
        np.testing.assert_allclose(place, plain.points[name], atol=2e-3)


def test_one_joint_that_jumps_for_some_frames_is_bridged(plain: Human) -> None:
    points = {name: place.copy() for name, place in plain.points.items()}
    points["left_ankle"][40:43] += [0.0, 0.8, 0.2]
    points["right_wrist"][70] += [1.0, 0.0, 0.0]
    human = without_jumps(replace(plain, points=points))
    assert [(one.start, one.end) for one in human.remarks] == [(0.8, 0.86), (1.4, 1.42)]
    np.testing.assert_allclose(human.points["left_ankle"], plain.points["left_ankle"], atol=2e-3)
    np.testing.assert_array_equal(human.points["left_knee"][50:60], plain.points["left_knee"][50:60])


def test_a_jump_that_nothing_takes_back_is_told(plain: Human) -> None:
    points = {
        name: place + np.where(np.arange(plain.count) < 60, 0.0, 2.0)[:, None] for name, place in plain.points.items()
    }
    (told,) = without_jumps(replace(plain, points=points)).remarks
    assert told.words == "The recording jumps by 3.48 m at 1.20 s: is it cut there?"


def test_a_fast_kick_or_wave_is_no_jump(plain: Human) -> None:
    times = plain.times
    kick = 0.9 * np.exp(-0.5 * ((times - 1.0) / 0.05) ** 2)  # up to 11 m/s
    points = plain.points | {"left_ankle": plain.points["left_ankle"] + kick[:, None] * [1.0, 0.0, 0.5]}
    fast = replace(plain, points=points)
    assert np.linalg.norm(np.diff(points["left_ankle"], axis=0), axis=1).max() * plain.rate > 10.0
    assert without_jumps(fast) is fast


def test_a_floor_that_drifts_is_levelled_and_told(danced: Callable[[Change], Human], plain: Human) -> None:
    human = danced(drifting)
    (told,) = human.remarks
    assert told.words.startswith("The recorded floor drifts up by 20 cm from 0.00 to 1.98 s")
    for joint in ("waist", "left_toe", "right_ankle"):
        off = human.points[joint][:, 2] - plain.points[joint][:, 2]
        assert np.abs(off).max() < 0.01


@pytest.mark.parametrize("seconds", [4.0, 12.0])
def test_a_floor_may_drift_to_and_fro(seconds: float) -> None:
    human = dancer(seconds)
    drift = 0.12 * np.sin(2.0 * np.pi * human.times / seconds)
    moved = replace(human, points={k: p + drift[:, None] * [0.0, 0.0, 1.0] for k, p in human.points.items()})
    level = on_level_floor(moved)
    assert "drifts by 2" in level.remarks[0].words
    heights = level.points["left_toe"][:, 2]
    assert np.ptp(heights) < 0.25 * np.ptp(drift)


def test_stairs_are_no_drift() -> None:
    human = dancer(6.0)
    up = np.zeros(human.count)
    foot = {side: np.zeros(human.count) for side in ("left", "right")}
    for k, start in enumerate(np.arange(0.5, 5.0, 1.0)):  # a foot after the other, 15 cm each
        rise = 0.15 * np.clip((human.times - start) / 0.3, 0.0, 1.0)
        foot["left" if k % 2 else "right"] += 2.0 * rise
        up += rise
    moved = {
        name: place
        + (foot.get(name.partition("_")[0], up) if name.endswith(("ankle", "toe")) else up)[:, None] * [0.0, 0.0, 1.0]
        for name, place in human.points.items()
    }
    climbing = replace(human, points=moved)
    assert on_level_floor(climbing) is climbing


def test_remarks_keep_the_clips_time_when_it_is_sliced(danced: Callable[[Change], Human]) -> None:
    human = danced(jumping)
    assert human.slice(0.5, 1.0).remarks == human.remarks
    assert human.slice(1.2).remarks == ()
    assert human.slice(0.5).slice(0.5, 0.3).start == pytest.approx(1.0)


def test_a_dance_on_the_spot_is_left_alone(plain: Human) -> None:
    assert plain.remarks == ()
    assert on_level_floor(without_jumps(plain)) is plain


def sloping(human: Human, slope: float) -> Human:
    """The human on a ramp along its way, upright as who walks on one is."""
    points = dict(human.points)
    for side in ("left", "right"):
        rise = slope * points[f"{side}_ankle"][:, :1] * [0.0, 0.0, 1.0]
        for joint in ("ankle", "toe"):
            points[f"{side}_{joint}"] = points[f"{side}_{joint}"] + rise
    body = slope * 0.5 * (human.points["left_ankle"][:, :1] + human.points["right_ankle"][:, :1]) * [0.0, 0.0, 1.0]
    for name in points:
        if not name.endswith(("ankle", "toe")):
            points[name] = points[name] + body
    return replace(human, points=points)


@pytest.mark.parametrize("slope", [0.08, -0.12])
def test_a_floor_that_slopes_is_levelled_and_told(slope: float) -> None:
    human = walker(steps=8, stride=0.35)
    level = on_level_floor(sloping(human, slope))
    (told,) = level.remarks
    assert told.words.startswith(f"The recorded floor slopes by {100 * abs(slope):.0f} %")
    assert told.climbed == pytest.approx(np.ptp(slope * human.points["waist"][:, 0]), rel=0.1)
    for side in ("left", "right"):
        kept, way = level.ground[f"{side}_foot"], human.points[f"{side}_ankle"][:, 0]
        np.testing.assert_allclose(kept - kept[0], slope * (way - way[0]), atol=0.06 * abs(slope))
        off = level.points[f"{side}_toe"][:, 2] - human.points[f"{side}_toe"][:, 2]
        np.testing.assert_allclose(off, off[0], atol=0.02)
    assert np.ptp(level.points["waist"][:, 2]) < 0.25 * abs(slope) * np.ptp(human.points["waist"][:, 0])


def test_who_walks_on_a_level_floor_stays_there() -> None:
    human = walker(steps=8, stride=0.35)
    assert on_level_floor(human) is human
