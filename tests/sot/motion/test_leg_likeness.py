import numpy as np
import pytest

from sot.motion.human.human import SIDES
from sot.motion.leg_likeness import foot_lift_ratio, foot_lifts, knee_bend, knee_bend_deg, robot_lifts

RATE, LEG, TOE = 50.0, 0.8, np.array([0.1, 0.0, 0.0])


def stander(lift, size=1.0):
    """Legs of a body on its left foot, whose right one is lifted by (T,) [leg lengths], the knee to the front."""
    count, points = len(lift), {}
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        up = lift if side == "right" else np.zeros(count)
        hip, ankle = np.tile([0.0, 0.1 * sign, LEG], (count, 1)), np.tile([0.0, 0.1 * sign, 0.0], (count, 1))
        ankle[:, 2] += LEG * up
        knee = 0.5 * (hip + ankle)
        knee[:, 0] += np.sqrt(np.maximum((0.5 * LEG) ** 2 - (0.5 * (hip - ankle)[:, 2]) ** 2, 0.0))
        points |= {f"{side}_hip": hip, f"{side}_knee": knee, f"{side}_ankle": ankle, f"{side}_toe": ankle + TOE}
    return {name: size * place for name, place in points.items()}


def hills(*heights):
    """A lift of a second for each height, with a second before and after each."""
    hill = np.sin(np.pi * np.linspace(0.0, 1.0, 50)) ** 2
    return np.concatenate([np.zeros(50), *(part for height in heights for part in (height * hill, np.zeros(50)))])


def test_a_body_lifts_its_feet_like_itself_in_any_size():
    human, other = stander(hills(0.3, 0.5)), stander(hills(0.3, 0.5), 1.4)
    assert foot_lift_ratio(human, other, RATE) == pytest.approx(1.0)
    assert [lift.side for lift in foot_lifts(human)] == ["right", "right"]


def test_half_the_height_is_half_the_ratio_and_more_than_the_human_s_makes_up_for_nothing():
    human = stander(hills(0.3, 0.3))
    assert foot_lift_ratio(human, stander(hills(0.15, 0.3)), RATE) == pytest.approx(0.75, abs=0.01)
    assert foot_lift_ratio(human, stander(hills(0.15, 0.45)), RATE) == pytest.approx(0.75, abs=0.01)


def test_who_never_lifts_a_foot_has_no_ratio():
    assert foot_lift_ratio(stander(hills(0.0)), stander(hills(0.3)), RATE) is None


def test_heels_that_rise_over_their_toes_are_no_lifts():
    human = stander(hills(0.3))
    human["right_toe"][:, 2] = 0.0
    assert foot_lifts(human) == []


def test_a_lift_that_comes_a_little_late_counts_for_its_own_and_for_no_other():
    human = stander(hills(0.3, 0.5))
    late = stander(np.concatenate([np.zeros(12), hills(0.2, 0.4)[:-12]]))
    assert robot_lifts(late, foot_lifts(human), RATE) == pytest.approx([0.2, 0.4], abs=0.01)


def test_bend_of_the_knee():
    straight, bent = stander(np.zeros(3)), stander(np.full(3, 0.5))
    assert knee_bend(bent, "left") == pytest.approx(0.0, abs=1e-6)
    assert knee_bend(bent, "right") == pytest.approx(2.0 * np.arccos(0.5))
    assert knee_bend_deg(straight, bent) == pytest.approx(60.0)
    assert knee_bend_deg(bent, straight) == pytest.approx(-60.0)
