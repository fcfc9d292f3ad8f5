"""A plan goes with its feet."""

import numpy as np
import pytest

from sot.behaviours.displacement import Displacement

LEFT, RIGHT = np.array([0.0, 0.1]), np.array([0.02, -0.1])


def test_feet_where_they_should_be_move_nothing():
    for feet in ((), [(LEFT, LEFT, 1.0)], [(LEFT, LEFT, 1.0), (RIGHT, RIGHT, 1.0)]):
        moved = Displacement.of(feet)
        np.testing.assert_array_equal(moved.displaced_place(RIGHT), RIGHT)
        np.testing.assert_array_equal(moved.displaced_rate(RIGHT), RIGHT)


def test_what_is_over_a_foot_stays_over_it():
    off, other = np.array([0.15, 0.02]), np.array([-0.01, -0.03])
    moved = Displacement.of([(LEFT, LEFT + off, 1.0), (RIGHT, RIGHT + other, 1.0)])
    for share in (0.0, 0.5, 1.0):
        planned = LEFT + share * (RIGHT - LEFT)
        np.testing.assert_allclose(moved.displaced_place(planned), planned + off + share * (other - off))


def test_a_foot_that_carries_nothing_does_not_count_and_one_that_begins_to_makes_no_jump():
    off = np.array([0.0, 0.2])
    one = Displacement.of([(LEFT, LEFT - off, 1.0)])
    places = [
        Displacement.of([(LEFT, LEFT - off, 1.0), (RIGHT, RIGHT, load)]).displaced_place(RIGHT)
        for load in np.linspace(0.0, 1.0, 11)
    ]
    np.testing.assert_allclose(places[0], one.displaced_place(RIGHT))
    np.testing.assert_allclose(places[-1], RIGHT, atol=1e-12)
    np.testing.assert_allclose(np.diff(places, axis=0), np.tile(0.1 * off, (10, 1)), atol=1e-12)


def test_a_velocity_is_the_rate_of_a_place():
    moved, x, v = Displacement.of([(LEFT, LEFT + 0.1, 1.0), (RIGHT, RIGHT, 1.0)]), np.array([0.03, 0.05]), np.ones(2)
    np.testing.assert_allclose(
        moved.displaced_rate(v), (moved.displaced_place(x + 1e-3 * v) - moved.displaced_place(x)) / 1e-3, rtol=1e-9
    )


def test_feet_planned_at_one_place():
    moved = Displacement.of([(LEFT, LEFT + 0.1, 1.0), (LEFT, LEFT, 1.0)])
    assert moved.displaced_place(LEFT) == pytest.approx(LEFT + 0.05)
