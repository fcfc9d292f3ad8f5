from dataclasses import replace

import numpy as np
import pytest

from sot.robots.lean_range import LEAN_RESOLUTION, UNLIMITED_LEAN, lean_of, pelvis_leans, trunk_leans
from sot.robots.robot import Robot
from tests.sot.robots.thick_legs import with_thick_legs


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def without_ranges(robot):
    """A robot whose joints turn as far as they like."""
    return replace(robot, lower=np.full(robot.na, -np.pi), upper=np.full(robot.na, np.pi))


def test_leans_of_axes():
    assert lean_of(np.array([[0.0, 0.0, 1.0]])).tolist() == [[0.0, 0.0]]
    axes = np.array([[np.sin(0.3), 0.0, np.cos(0.3)], [0.0, -np.sin(1.2), np.cos(1.2)]])
    np.testing.assert_allclose(lean_of(axes), [[0.3, 0.0], [0.0, -1.2]], atol=1e-12)


def test_ranges_that_end_before_legs_meet_limit_no_lean(robot):
    """HRP-2's hips roll by no more than its thighs allow."""
    np.testing.assert_allclose(np.abs(pelvis_leans(robot)), UNLIMITED_LEAN)


def test_legs_that_meet_limit_the_lean_to_the_side(robot):
    """Thighs w apart from axis to axis and r thick are w cos φ − 2 r apart under a pelvis that rolls by φ over upright
    legs: with thicker legs they meet sooner, a lean forward brings them no nearer."""
    limits = [pelvis_leans(without_ranges(with_thick_legs(robot, more))) for more in (0.0, 0.012, 0.024)]
    for (right, left), width in zip([limit[:, 1] for limit in limits], (0.064, 0.04, 0.016), strict=True):
        alone = np.arccos(1.0 - (width - min(0.02, 0.75 * width)) / 0.19)  # the body's sway rolls the hips farther
        assert right == pytest.approx(-left, abs=2.0 * LEAN_RESOLUTION)
        assert 0.5 * alone < left < alone + LEAN_RESOLUTION
    assert limits[0][1, 1] > limits[1][1, 1] > limits[2][1, 1] > 0.0
    np.testing.assert_allclose([limit[1, 0] for limit in limits], UNLIMITED_LEAN)


def test_a_waist_adds_what_its_joints_turn(robot):
    """HRP-2's chest turns and pitches: trunk and pelvis lean as far to the side, the trunk farther forward."""
    thick = without_ranges(with_thick_legs(robot, 0.02))
    turn, pitch = robot.groups["chest"]
    lower, upper = thick.lower.copy(), thick.upper.copy()
    lower[[turn, pitch]], upper[[turn, pitch]] = robot.lower[[turn, pitch]], robot.upper[[turn, pitch]]
    thick = replace(thick, lower=lower, upper=upper)
    pelvis, trunk = pelvis_leans(thick), trunk_leans(thick)
    np.testing.assert_allclose(trunk[:, 1], pelvis[:, 1], atol=0.01)
    assert 0.4 * robot.upper[pitch] < trunk[1, 0] - pelvis[1, 0] < robot.upper[pitch]


def test_legs_that_cannot_lean_at_all_limit_no_lean(robot):
    """Without the roll of the ankles no lean to the side leaves feet flat: it is not legs that meet."""
    thick = without_ranges(with_thick_legs(robot, 0.024))
    groups = dict(thick.groups) | {leg: thick.groups[leg][:5] for leg in ("left_leg", "right_leg")}
    np.testing.assert_allclose(np.abs(pelvis_leans(replace(thick, groups=groups))[:, 1]), UNLIMITED_LEAN)
