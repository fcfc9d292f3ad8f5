"""References that go over from one aim to the next: continuous, with true derivatives."""

from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest

from sot.behaviours.manipulation.guide import (
    PlaneGuide,
    PoseGuide,
    attached_reference,
    closing_reference,
    fixed_place,
    fixed_reference,
    placement_of,
)
from sot.control.pose import Pose

DT = 1e-4


def turning(t):
    """A body that moves and turns at a rising speed."""
    w, a = np.array([0.3, -0.2, 0.9]), np.array([0.1, 0.4, -0.2])
    angle = 0.5 * t**2
    axis = w / np.linalg.norm(w)
    velocity = np.concatenate([a * t, axis * t])
    return Pose(0.5 * a * t**2, pin.exp3(angle * axis), velocity, np.concatenate([a, axis]))


def derivatives_hold(reference, times):
    poses = [reference(t) for t in times]
    x, v, a = (np.array([getattr(p, name) for p in poses]) for name in ("position", "velocity", "acceleration"))
    spin = np.array([pin.log3(q.rotation @ p.rotation.T) for p, q in pairwise(poses)]) / DT
    mean = 0.5 * (v[1:] + v[:-1])
    assert np.abs(np.diff(x, axis=0) / DT - mean[:, :3]).max() < 1e-4
    assert np.abs(spin - mean[:, 3:]).max() < 1e-4
    assert np.abs(np.diff(v, axis=0) / DT - 0.5 * (a[1:] + a[:-1])).max() < 1e-2


def test_an_attached_point_moves_with_its_body():
    offset = pin.SE3(pin.exp3(np.array([0.2, 0.1, -0.4])), np.array([0.3, -0.1, 0.2]))
    derivatives_hold(attached_reference(turning, offset), np.arange(0.2, 0.4, DT))


def test_a_guide_goes_over_without_a_jump():
    guide = PoseGuide(turning)
    before = guide(0.5)
    goal = pin.SE3(pin.exp3(np.array([0.0, 0.6, 0.3])), np.array([0.2, 0.1, 0.4]))
    guide.lead_by(fixed_reference(goal), 0.5, 0.8)
    after = guide(0.5)
    assert after.position == pytest.approx(before.position) and after.rotation == pytest.approx(before.rotation)
    derivatives_hold(guide, np.arange(0.55, 1.25, DT))
    assert placement_of(guide(1.4)).isApprox(goal, 1e-12)


def test_a_fade_onto_a_moving_body_has_true_derivatives():
    guide = PoseGuide(fixed_reference(pin.SE3.Random()))
    guide.lead_by(turning, 0.0, 0.5)
    derivatives_hold(guide, np.arange(0.05, 0.45, DT))


def test_closing_in_starts_smoothly():
    reference = closing_reference(pin.SE3.Identity(), np.array([0.0, 0.0, -0.03]), 1.0, 0.2)
    derivatives_hold(reference, np.arange(1.001, 1.19, DT))
    assert reference(2.0).position[2] == pytest.approx(-0.03 * 0.9)


def swaying(t):
    place, speed = np.array([0.1 * np.sin(t), 0.05 * t**2]), np.array([0.1 * np.cos(t), 0.1 * t])
    return place, speed, np.array([-0.1 * np.sin(t), 0.1])


def test_the_centre_of_mass_goes_over_from_where_it_is():
    guide = PlaneGuide(fixed_place(np.array([0.0, 0.1])), 0.15)
    guide.lead_by(fixed_place(np.array([0.05, -0.1])), 0.0, 1.0)
    middle = guide(0.4)
    guide.lead_by(swaying, 0.4, 0.7)
    for old, new in zip(middle, guide(0.4), strict=True):
        assert new == pytest.approx(old)
    rows = np.array([np.concatenate(guide(t)) for t in np.arange(0.4, 1.09, DT)])
    x, v, a = rows[:, :3], rows[:, 3:6], rows[:, 6:]
    assert np.abs(np.diff(x, axis=0) / DT - 0.5 * (v[1:] + v[:-1])).max() < 1e-4
    assert np.abs(np.diff(v, axis=0) / DT - 0.5 * (a[1:] + a[:-1])).max() < 1e-2
    assert guide(1.2)[0][:2] == pytest.approx(swaying(1.2)[0], abs=1e-12)


def test_a_change_of_owner_starts_from_the_other_centre():
    guide = PlaneGuide(fixed_place(np.zeros(2)), 0.15)
    guide.restart(np.array([0.04, 0.0]), np.array([0.01, 0.0]), 2.0, 0.8)
    assert guide(2.0)[0] == pytest.approx([0.04, 0.0, 0.0]) and guide(2.0)[1] == pytest.approx([0.01, 0.0, 0.0])
    assert guide(2.9)[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_a_shift_comes_in_slowly():
    guide = PlaneGuide(fixed_place(np.zeros(2)), 0.15)
    for t in np.arange(0.0, 1.0, 0.001):
        guide.shift_by(np.array([0.1, 0.0]), t)
        if abs(t - 0.15) < 1e-9:
            assert guide(t)[0][0] == pytest.approx(0.1 * (1.0 - np.exp(-1.0)), abs=2e-3)
    assert guide(1.0)[0][0] == pytest.approx(0.1, abs=1e-3)
