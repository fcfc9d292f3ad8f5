import numpy as np
import pinocchio as pin
import pytest

from sot.motion.body.coordinates import from_configuration, to_acceleration, to_configuration, to_rotation, to_velocity

STEP = 1e-5


@pytest.fixture
def model():
    return pin.buildSampleModelHumanoid()


def path(model, t):
    """A smooth path in coordinates, with a whole turn of yaw, and its two derivatives."""
    phase = np.linspace(0.0, 1.0, model.nv)
    rate = 1.0 + phase
    y = np.sin(np.outer(t, rate) + phase)
    dy = rate * np.cos(np.outer(t, rate) + phase)
    ddy = -(rate**2) * y
    for array, value in zip((y, dy, ddy), (2.5 * t, 2.5, 0.0), strict=True):
        array[:, 5] = value
    return y, dy, ddy


def test_rotation_turns_by_roll_then_pitch_then_yaw():
    angles = np.random.default_rng(0).uniform(-3.0, 3.0, (5, 3))
    np.testing.assert_allclose(to_rotation(angles), [pin.rpy.rpyToMatrix(rpy) for rpy in angles], atol=1e-14)


def test_velocity_is_the_derivative_of_the_configuration(model):
    t = np.linspace(0.0, 4.0, 30)
    y, dy, _ = path(model, t)
    before, after = (to_configuration(path(model, t + sign * STEP)[0]) for sign in (-1, 1))
    difference = [pin.difference(model, a, b) / (2 * STEP) for a, b in zip(before, after, strict=True)]
    np.testing.assert_allclose(to_velocity(y, dy), difference, atol=1e-7)


def test_acceleration_is_the_derivative_of_the_velocity(model):
    t = np.linspace(0.0, 4.0, 30)
    y, dy, ddy = path(model, t)
    before, after = (to_velocity(*path(model, t + sign * STEP)[:2]) for sign in (-1, 1))
    np.testing.assert_allclose(to_acceleration(y, dy, ddy), (after - before) / (2 * STEP), atol=1e-7)


def test_configuration_and_back_is_continuous_through_whole_turns(model):
    y, _, _ = path(model, np.linspace(0.0, 4.0, 400))
    q = to_configuration(y)
    assert np.all(np.sum(q[1:, 3:7] * q[:-1, 3:7], axis=1) > 0.9)
    np.testing.assert_allclose(from_configuration(q), y, atol=1e-9)
