"""Clips joined end to end: bones keep their lengths, and nothing jumps at a seam."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.live.streams.seams import SEAM_TIME, joined, repeated
from sot.motion.human.capture import Capture
from tests.sot.live.streams.clips import groove


def part(first, last):
    clip = groove()
    return Capture(
        clip.name, clip.rate, clip.joints, clip.parents, clip.positions[first:last], clip.rotations[first:last]
    )


def turned(clip, angle, shift):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return Capture(
        clip.name, clip.rate, clip.joints, clip.parents, clip.positions @ turn.T + shift, turn @ clip.rotations
    )


def bone_lengths(clip):
    return np.linalg.norm(clip.positions[:, 1:] - clip.positions[:, clip.parents[1:]], axis=2)


def largest_step(clip):
    return np.abs(np.diff(clip.positions, axis=0)).max()


def test_a_clip_goes_on_where_the_one_before_ended_whichever_way_it_faced():
    first, second = part(0, 120), turned(part(200, 320), 2.0, [3.0, -1.0, 0.0])
    whole = joined([first, second])
    assert whole.duration == pytest.approx(first.duration + second.duration - SEAM_TIME, abs=1.5 / first.rate)
    assert largest_step(whole) < 2.0 * max(largest_step(first), largest_step(second))
    np.testing.assert_allclose(bone_lengths(whole), np.tile(bone_lengths(first)[0], (whole.frames, 1)), atol=1e-6)
    np.testing.assert_allclose(whole.positions[:60], first.positions[:60])


def test_a_clip_is_repeated_for_as_long_as_asked():
    clip = part(0, 150)
    whole = repeated(clip, 10.0)
    assert whole.duration == pytest.approx(10.0)
    assert largest_step(whole) < 2.0 * largest_step(clip)


def test_other_skeletons_and_clips_shorter_than_their_seams_are_refused():
    clip = part(0, 150)
    other = Capture(
        "other", clip.rate, tuple(f"{n}_" for n in clip.joints), clip.parents, clip.positions, clip.rotations
    )
    with pytest.raises(InputError, match="different skeletons"):
        joined([clip, other])
    with pytest.raises(InputError, match="a seam needs"):
        repeated(part(0, 20), 5.0)
