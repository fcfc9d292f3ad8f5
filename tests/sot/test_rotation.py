"""Rotation vectors against Pinocchio's, and back through its exponential."""

import numpy as np
import pinocchio as pin
import pytest

from sot.rotation import quaternion, rotation_vector


def vectors(angle, count=50):
    axes = np.random.default_rng(0).normal(size=(count, 3))
    axes[:3] = np.eye(3)
    return angle * axes / np.linalg.norm(axes, axis=1, keepdims=True)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-9, 1e-6, 0.1, 1.5, 2.6, 2.7, 3.1, np.pi - 1e-5])
def test_they_are_pinocchios(angle):
    for vector in vectors(angle):
        np.testing.assert_allclose(rotation_vector(pin.exp3(vector)), vector, atol=1e-9)
        np.testing.assert_allclose(rotation_vector(pin.exp3(vector)), pin.log3(pin.exp3(vector)), atol=1e-7)


@pytest.mark.parametrize("short", [1e-8, 1e-12, 0.0])
def test_half_a_turn_is_one_about_the_same_axis(short):
    for vector in vectors(np.pi - short):
        found = rotation_vector(pin.exp3(vector))
        assert np.linalg.norm(found) == pytest.approx(np.pi, abs=1e-7)
        np.testing.assert_allclose(pin.exp3(found), pin.exp3(vector), atol=1e-7)


def test_quaternion_of_any_rotation_is_pinocchios():
    rng = np.random.default_rng(4)
    turns = [pin.exp3(rng.uniform(0, np.pi) * axis / np.linalg.norm(axis)) for axis in rng.standard_normal((50, 3))]
    turns += [pin.exp3(angle * axis) for axis in np.eye(3) for angle in (0.0, np.pi - 1e-9, np.pi)]
    for R in turns:
        expected = pin.Quaternion(R).coeffs()
        found = quaternion(R)
        np.testing.assert_allclose(np.outer(found, found), np.outer(expected, expected), atol=1e-12)
