import numpy as np
import pytest

from sot.motion.body.swing_fit import LEAST_ROOM, AirLimits, nearest_path

PERIOD, COUNT = 0.02, 49
LIMITS = AirLimits(speed=1.6, acceleration=12.0, leg=0.6)
STILL = np.zeros((COUNT + 2, 1))
SHARE = np.arange(1, COUNT + 1) / (COUNT + 1)
FLOOR = np.zeros(COUNT)
UP = np.ones((COUNT, 1))


def with_ends(path, ends):
    return np.vstack([ends[[0, 0]], path, ends[[1, 1]]])


def test_a_wanted_path_within_the_limits_is_taken():
    wanted = 0.2 * np.sin(np.pi * SHARE)[:, None] ** 4
    found = nearest_path(wanted, np.zeros((2, 1)), STILL, PERIOD, LIMITS, UP, FLOOR)
    np.testing.assert_allclose(found, wanted, atol=0.006)


def test_a_foot_that_is_held_in_the_air_stays_there():
    wanted = np.full((COUNT, 1), 0.2)
    found = nearest_path(wanted, np.zeros((2, 1)), STILL, PERIOD, LIMITS, UP, FLOOR)
    assert np.abs(found[20:-20] - 0.2).max() < 0.01


def test_speed_relative_to_the_hips_and_acceleration_are_kept_and_ends_are_at_rest():
    wanted = np.where(SHARE < 0.5, 0.0, 0.8)[:, None]
    ends, hips = np.array([[0.0], [0.8]]), 0.5 * PERIOD * np.arange(COUNT + 2)[:, None]
    found = nearest_path(wanted, ends, hips, PERIOD, LIMITS, UP, FLOOR - 1.0)
    path = with_ends(found, ends)
    speed, bend = np.diff(path, axis=0)[1:-1] / PERIOD, np.diff(path, 2, axis=0) / PERIOD**2
    assert np.abs(speed - 0.5).max() < LIMITS.speed + 1e-6 < np.abs(speed).max()
    assert np.abs(bend).max() < LIMITS.acceleration + 1e-6
    assert max(np.abs(bend[0]), np.abs(bend[-1])) < 0.2 * LIMITS.acceleration


def test_a_way_that_asks_for_more_than_the_limits_gets_a_little_more_than_it_needs():
    ends = np.array([[0.0], [3.0]])
    found = nearest_path(3.0 * SHARE[:, None], ends, STILL, PERIOD, LIMITS, UP, FLOOR - 1.0)
    speed = np.diff(with_ends(found, ends), axis=0) / PERIOD
    assert LIMITS.speed < np.abs(speed).max() <= LEAST_ROOM * 1.875 * 3.0 / (PERIOD * (COUNT + 1)) + 1e-6


def test_a_path_keeps_to_one_side():
    ways, least = np.tile([0.0, 1.0], (COUNT, 1)), 0.1 * np.sin(np.pi * SHARE) ** 4
    found = nearest_path(np.zeros((COUNT, 2)), np.zeros((2, 2)), np.zeros((COUNT + 2, 2)), PERIOD, LIMITS, ways, least)
    assert (found[:, 1] >= least - 1e-9).all()
    assert found[:, 0] == pytest.approx(0.0, abs=1e-9)


def test_limits_that_contradict_one_another_have_no_path():
    high = np.full(COUNT, 0.3)
    assert nearest_path(np.zeros((COUNT, 1)), np.zeros((2, 1)), STILL, PERIOD, LIMITS, UP, high) is None
