"""A path of poses: through its samples, with true derivatives, at rest beyond both ends."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from sot.motion.objects.pose_path import PosePath, blended


def path(rate=500.0):
    times = 1.0 + np.arange(31) / 30.0
    s = times - 1.0
    position = np.column_stack([s**2 * (1 - s) ** 2, 0.2 * np.sin(np.pi * s) ** 2, s**3 * (10 - 15 * s + 6 * s**2)])
    turn = Rotation.from_rotvec(np.outer(s**3 * (10 - 15 * s + 6 * s**2), [0.4, -0.3, 0.8]))
    return times, position, turn.as_matrix(), PosePath.through(times, position, turn.as_matrix(), rate)


def test_it_goes_through_its_samples():
    times, position, rotation, made = path()
    for k in (0, 7, 22, 30):
        pose = made(times[k])
        assert pose.position == pytest.approx(position[k], abs=1e-4)
        assert pin.log3(pose.rotation @ rotation[k].T) == pytest.approx(np.zeros(3), abs=1e-3)


def test_velocities_and_accelerations_are_the_derivatives():
    _, _, _, made = path()
    dt = 1e-3
    poses = [made(t) for t in np.arange(1.2, 1.8, dt)]
    x, v, a = (np.array([getattr(p, name) for p in poses]) for name in ("position", "velocity", "acceleration"))
    spin = np.array([pin.log3(poses[k + 2].rotation @ poses[k].rotation.T) for k in range(len(poses) - 2)]) / (2 * dt)
    assert np.abs((x[2:] - x[:-2]) / (2 * dt) - v[1:-1, :3]).max() < 2e-3
    assert np.abs(spin - v[1:-1, 3:]).max() < 5e-3
    assert np.abs((v[2:] - v[:-2]) / (2 * dt) - a[1:-1]).max() < 0.1


def test_it_rests_beyond_its_ends():
    _, position, _, made = path()
    for t in (0.0, 0.5, 3.0):
        assert not made(t).velocity.any() and not made(t).acceleration.any()
    assert made(0.0).position == pytest.approx(position[0]) and made(9.0).position == pytest.approx(position[-1])


def test_a_blend_is_the_one_at_nought_and_the_other_at_one():
    one, other = pin.SE3.Random(), pin.SE3.Random()
    position, rotation = blended([one] * 3, [other] * 3, np.array([0.0, 0.5, 1.0]))
    assert pin.SE3(rotation[0], position[0]).isApprox(one, 1e-9)
    assert pin.SE3(rotation[2], position[2]).isApprox(other, 1e-9)
    half = pin.log3(rotation[1] @ one.rotation.T)
    assert 2.0 * half == pytest.approx(pin.log3(other.rotation @ one.rotation.T))
