"""The centre of mass among the supports: exact where the paper's (32) is not, and the same where it is right."""

import numpy as np
import pytest

from sot.gravity import GRAVITY
from sot.motion.objects.support import (
    com_over_supports,
    com_shift_of_hands,
    normalised_offsets,
    support_centre,
)

FEET_AND_HAND = np.array([[0.0, 0.1], [0.0, -0.1], [0.55, -0.25]])
COM = np.array([0.15, -0.03])


def as_printed(supports, com, reference):
    """Otani (31) and (32) with a support as p0, back on the same supports."""
    p0 = supports[reference]
    place = p0.copy()
    for k, p in enumerate(supports):
        if k != reference:
            way = p - p0
            place += (com - p0) @ way / (way @ way) * way
    return place


def test_three_supports_are_exact():
    assert com_over_supports(FEET_AND_HAND, COM, FEET_AND_HAND) == pytest.approx(COM, abs=1e-12)


def test_the_printed_form_misses_the_same_body_and_depends_on_the_choice():
    missed = [np.linalg.norm(as_printed(FEET_AND_HAND, COM, k) - COM) for k in range(3)]
    assert min(missed) > 0.01 and max(missed) > 2.0 * min(missed)


def test_two_supports_give_the_projection_as_the_paper_does():
    feet = FEET_AND_HAND[:2]
    assert com_over_supports(feet, COM, feet) == pytest.approx(as_printed(feet, COM, 0), abs=1e-12)


def test_the_weights_are_those_nearest_to_equal_ones():
    four = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    weights = normalised_offsets(four, np.array([0.6, 0.3]))
    assert weights.sum() == pytest.approx(1.0) and weights @ four == pytest.approx([0.6, 0.3])
    null = np.array([1.0, -1.0, 1.0, -1.0])  # changes neither: any share of it is farther from equal
    assert weights @ null == pytest.approx(0.0, abs=1e-12)
    assert normalised_offsets(four, four.mean(axis=0)) == pytest.approx(np.full(4, 0.25))


def test_another_body_keeps_its_share():
    robot = 0.7 * FEET_AND_HAND + [0.3, 0.2]
    assert com_over_supports(FEET_AND_HAND, COM, robot) == pytest.approx(0.7 * COM + [0.3, 0.2])
    assert com_over_supports(FEET_AND_HAND[:1], COM, robot[:1]) == pytest.approx(robot[0])


def test_the_support_centre_is_that_of_the_hull():
    corners = np.array([[0.1, 0.2], [-0.1, 0.2], [-0.1, -0.2], [0.1, -0.2], [0.02, 0.03]])
    assert support_centre(corners) == pytest.approx([0.0, 0.0], abs=1e-12)


def test_the_shift_balances_the_hands():
    force, point, middle, mass = (
        np.array([-60.0, 10.0, 5.0]),
        np.array([0.5, -0.2, 0.9]),
        np.array([0.02, 0.01, 0.0]),
        58.0,
    )
    shift = com_shift_of_hands(force[None], point[None], middle, mass)
    weight = np.array([0.0, 0.0, -mass * GRAVITY])
    total = np.cross(point - middle, force) + np.cross(np.append(shift, 0.8), weight)
    assert total[:2] == pytest.approx([0.0, 0.0], abs=1e-9) and shift[0] > 0.0
