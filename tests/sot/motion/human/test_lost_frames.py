"""Frames that a tracker held in the midst of a move, and a dancer who only stands still."""

from dataclasses import replace

import numpy as np
import pytest

from sot.motion import Human
from sot.motion.human.lost_frames import with_lost_frames_bridged
from tests.sot.motion.human.humans import dancer


def held(human: Human, first: int, count: int) -> Human:
    def hold(values: np.ndarray) -> np.ndarray:
        values = values.copy()
        values[first + 1 : first + 1 + count] = values[first]
        return values

    return replace(
        human,
        points={name: hold(place) for name, place in human.points.items()},
        frames={body: hold(turns) for body, turns in human.frames.items()},
    )


def test_a_few_lost_frames_are_bridged_and_told() -> None:
    human = dancer(3.0)
    found = with_lost_frames_bridged(held(human, 40, 6))
    (told,) = found.remarks
    assert told.words == "The recording stops from 1.00 to 1.15 s: it is bridged there."
    for name, place in human.points.items():
        assert np.abs(found.points[name] - place).max() < 0.03
        assert np.abs(np.diff(found.points[name] - place, axis=0)).max() < 0.02


def test_many_are_left_and_told() -> None:
    lost = held(dancer(4.0), 40, 60)
    found = with_lost_frames_bridged(lost)
    assert [one.words for one in found.remarks] == [
        "The recording stops from 1.00 to 2.50 s: it is danced as it is, motionless."
    ]
    np.testing.assert_array_equal(found.points["left_wrist"], lost.points["left_wrist"])


@pytest.mark.parametrize(("first", "count"), [(0, 30), (90, 30), (40, 1)])
def test_stillness_at_the_ends_and_a_doubled_rate_lose_nothing(first: int, count: int) -> None:
    human = held(dancer(3.0), first, count)
    assert with_lost_frames_bridged(human) is human
