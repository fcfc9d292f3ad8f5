import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.motion.likeness import (
    LEG_SEGMENTS,
    UPPER_SEGMENTS,
    hand_path_ratio,
    heading_difference_deg,
    hip_heading,
    mean_segment_angle_deg,
    segment_angles,
)
from tests.sot.motion.human.humans import RATE, dancer


@pytest.fixture
def human():
    return dancer().points


def moved(points, rotation, scale=1.0):
    return {name: scale * rotation.apply(place) for name, place in points.items()}


def test_a_body_is_like_itself_in_any_size_place_and_heading(human):
    other = {
        name: place + np.array([3.0, 1.0, 0.2])
        for name, place in moved(human, Rotation.from_euler("z", 2.0), 0.7).items()
    }
    assert mean_segment_angle_deg(human, other) == pytest.approx(0.0, abs=1e-5)
    assert hand_path_ratio(human, other, RATE) == pytest.approx(1.0)


def test_angle_of_a_bent_forearm(human):
    bend = Rotation.from_rotvec([0.0, 0.3, 0.0])
    other = dict(human)
    other["left_wrist"] = human["left_elbow"] + bend.apply(human["left_wrist"] - human["left_elbow"])
    angles = segment_angles(human, other)
    assert 0.1 < angles["left_forearm"].max() <= 0.3 + 1e-9
    assert max(angle.max() for name, angle in angles.items() if name != "left_forearm") < 1e-7
    assert mean_segment_angle_deg(human, other, UPPER_SEGMENTS) == pytest.approx(
        np.degrees(angles["left_forearm"].mean()) / 6
    )
    assert mean_segment_angle_deg(human, other) == pytest.approx(np.degrees(angles["left_forearm"].mean()) / 10)


def test_legs_do_not_count_above_the_waist(human):
    other = human | {"left_knee": human["left_knee"] + np.array([0.1, 0.0, 0.0])}
    assert mean_segment_angle_deg(human, other, UPPER_SEGMENTS) == pytest.approx(0.0, abs=1e-6)
    assert mean_segment_angle_deg(human, other, LEG_SEGMENTS) > 2.0


def test_calmed_down_hands_travel_less(human):
    other = dict(human)
    for side in ("left", "right"):
        hand = human[f"{side}_wrist"] - human["waist"]
        other[f"{side}_wrist"] = human["waist"] + hand.mean(axis=0) + 0.5 * (hand - hand.mean(axis=0))
    assert hand_path_ratio(human, other, RATE) == pytest.approx(0.5, abs=0.1)


def test_hands_that_hardly_move_have_no_ratio(human):
    still = {name: np.tile(place[:1], (50, 1)) for name, place in human.items()}
    assert hand_path_ratio(still, human, RATE) is None


def test_heading_counts_from_where_both_begin_and_not_in_whole_turns():
    theirs = np.linspace(0.0, 7.0, 50)
    assert heading_difference_deg(theirs, theirs + 2.0 - 2.0 * np.pi) == pytest.approx(0.0, abs=1e-6)
    swaying = theirs + 0.1 * np.tile([1.0, -1.0], 25)
    assert heading_difference_deg(theirs, swaying) == pytest.approx(np.degrees(0.1))


def test_heading_of_a_turned_body(human):
    turned = moved(human, Rotation.from_euler("z", 0.4))
    assert np.angle(np.exp(1j * (hip_heading(turned) - hip_heading(human)))) == pytest.approx(0.4)
