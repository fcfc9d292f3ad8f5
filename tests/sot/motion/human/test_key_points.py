"""Eight key points: what they are of a human, in other lengths, and as a human again."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion.human.key_points import (
    KEY_POINTS,
    UpperBodyLengths,
    human_from_key_points,
    key_points_of,
    parse_key_points,
)
from tests.sot.motion.human.humans import LENGTHS, RATE, dancer

ROBOT = UpperBodyLengths(trunk=0.4, breadth=0.5, head=0.2, upper_arm=0.25, forearm=0.3)


def test_words_name_key_points():
    assert parse_key_points("head, waist,hands") == ("waist", "left_wrist", "right_wrist", "head")
    assert parse_key_points(",".join(KEY_POINTS)) == KEY_POINTS and len(KEY_POINTS) == 8
    for wrong in ("waist,foot", "", "waist,,head"):
        with pytest.raises(InputError, match="is no key point"):
            parse_key_points(wrong)


def test_lengths_are_those_of_the_body():
    lengths = UpperBodyLengths.of(key_points_of(dancer()))
    assert lengths.trunk == pytest.approx(LENGTHS["neck"]) and lengths.head == pytest.approx(LENGTHS["head"])
    assert lengths.breadth == pytest.approx(2 * LENGTHS["shoulder"])
    assert lengths.upper_arm == lengths.forearm == pytest.approx(LENGTHS["arm"])


def test_other_lengths_keep_directions_and_the_waist():
    human = dancer()
    scaled = ROBOT.applied_to(key_points_of(human))
    assert tuple(scaled) == KEY_POINTS
    np.testing.assert_array_equal(scaled["waist"], human.points["waist"])
    assert UpperBodyLengths.of(scaled).__dict__ == pytest.approx(ROBOT.__dict__)
    forearm = scaled["left_wrist"] - scaled["left_elbow"]
    np.testing.assert_allclose(forearm / ROBOT.forearm, human.segment_direction("left_forearm"), atol=1e-12)
    # In the lengths that it has, a body is what it was.
    again = UpperBodyLengths.of(key_points_of(human)).applied_to(key_points_of(human))
    for name in KEY_POINTS:
        np.testing.assert_allclose(again[name], human.points[name], atol=1e-9)


def test_one_frame_scales_as_a_clip_does():
    points = key_points_of(dancer())
    clip, frame = ROBOT.applied_to(points), ROBOT.applied_to({name: place[17] for name, place in points.items()})
    for name in KEY_POINTS:
        np.testing.assert_allclose(frame[name], clip[name][17], atol=1e-12)


def test_a_human_comes_of_its_key_points():
    human = dancer()
    reduced = human_from_key_points(key_points_of(human), RATE, leg=human.leg)
    for name in KEY_POINTS:
        np.testing.assert_array_equal(reduced.points[name], human.points[name])
    assert set(reduced.points) == set(human.points) and reduced.leg == pytest.approx(human.leg, rel=0.02)
    np.testing.assert_allclose(reduced.points["neck"], human.points["neck"], atol=1e-9)
    np.testing.assert_allclose(reduced.frames["chest"], human.frames["chest"], atol=1e-6)
    for body, rotation in reduced.frames.items():
        np.testing.assert_allclose(
            rotation @ rotation.swapaxes(1, 2), np.broadcast_to(np.eye(3), rotation.shape), atol=1e-12, err_msg=body
        )
    toes = reduced.points["left_toe"] - reduced.points["left_ankle"]
    assert (np.einsum("ti,ti->t", toes, reduced.frames["pelvis"][:, :, 0]) > 0.0).all()
    one = human_from_key_points({name: place[:1] for name, place in key_points_of(human).items()}, RATE)
    assert one.count == 1 and one.leg == pytest.approx(1.6 * LENGTHS["neck"], rel=0.02)


def test_a_human_takes_all_of_them():
    points = key_points_of(dancer(), parse_key_points("waist,hands,head"))
    with pytest.raises(InputError, match="missing: left_shoulder"):
        human_from_key_points(points, RATE)
