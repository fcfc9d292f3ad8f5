"""A foot's way to a place that may change while it swings."""

import numpy as np
import pytest

from sot.behaviours.stride import BUMP_CURVATURE, LANDING_DEPTH, Stride, bump, bump_curve, lowered_pose, raised_pose
from sot.control.pose import Pose

START, TO, OTHER = np.array([0.1, 0.2, 0.001]), np.array([0.4, 0.25]), np.array([0.3, 0.4])
LIFT, LAND, HEIGHT = 0.5, 0.8, 0.05
STEP = 1e-5


@pytest.fixture
def way() -> Stride:
    stride = Stride(START, np.eye(3), LIFT, LAND, HEIGHT)
    stride.redirect(LIFT, TO)
    return stride


def test_it_leaves_and_lands_at_rest(way):
    before, after = way(LIFT), way(LAND)
    np.testing.assert_allclose(before.position, START, atol=1e-12)
    np.testing.assert_allclose(after.position, (*TO, -LANDING_DEPTH), atol=1e-12)
    for pose in (before, after):
        np.testing.assert_allclose(pose.velocity, 0.0, atol=1e-9)
        np.testing.assert_allclose(pose.acceleration[:2], 0.0, atol=1e-9)
    assert max(way(t).position[2] for t in np.linspace(LIFT, LAND, 31)) == pytest.approx(HEIGHT, abs=3e-3)


def test_velocity_and_acceleration_are_derivatives(way):
    way.redirect(0.6, OTHER)
    for t in np.linspace(LIFT + 0.11, LAND - 0.01, 9):
        before, now, after = way(t - STEP), way(t), way(t + STEP)
        np.testing.assert_allclose(now.velocity[:3], (after.position - before.position) / (2 * STEP), atol=1e-6)
        np.testing.assert_allclose(now.acceleration, (after.velocity - before.velocity) / (2 * STEP), atol=1e-4)


def test_led_elsewhere_it_goes_on_without_a_kick_and_lands_there(way):
    before = way(0.62)
    way.redirect(0.62, OTHER)
    for old, new in zip(before, way(0.62), strict=True):
        np.testing.assert_allclose(new, old, atol=1e-9)
    np.testing.assert_allclose(way(LAND).position[:2], OTHER, atol=1e-12)
    way.redirect(LAND + 0.1, TO)  # too late
    np.testing.assert_allclose(way(LAND).position[:2], OTHER, atol=1e-12)


def test_it_says_how_fast_it_would_turn_and_speed_up(way):
    speed, acceleration = way.peak_rates(0.62, OTHER, 0.4)
    way.redirect(0.62, OTHER, 0.4)
    rest = [way(t) for t in np.linspace(0.62, LAND - 1e-9, 200)]
    assert speed == pytest.approx(max(abs(pose.velocity[5]) for pose in rest), rel=0.02)
    assert acceleration == pytest.approx(max(np.linalg.norm(pose.acceleration[:2]) for pose in rest), rel=0.05)


def test_a_late_foot_is_lowered(way):
    assert lowered_pose(way(0.7), -0.1).position[2] == way(0.7).position[2]
    depths = np.array([-way(LAND + late).position[2] for late in np.arange(0.0, 0.1, STEP * 100)])
    speeds = [way(LAND + late).velocity[2] for late in np.arange(0.0, 0.1, STEP * 100)]
    assert np.all(np.diff(depths) >= 0.0) and depths[-1] > LANDING_DEPTH + 0.005
    np.testing.assert_allclose(np.gradient(depths, STEP * 100)[1:-1], np.negative(speeds)[1:-1], atol=2e-3)


def test_raised_it_ends_higher_and_says_how_fast():
    floor = Pose(np.zeros(3), np.eye(3), np.zeros(6), np.zeros(6))

    def at(t: float) -> Pose:
        return raised_pose(floor, 0.01, t, 0.4)

    assert at(-1.0).position[2] == 0.0
    assert at(0.4).position[2] == at(1.0).position[2] == pytest.approx(0.01)
    for t in np.linspace(0.02, 0.38, 7):
        before, now, after = at(t - STEP), at(t), at(t + STEP)
        np.testing.assert_allclose(now.velocity[2], (after.position[2] - before.position[2]) / (2 * STEP), atol=1e-8)
        np.testing.assert_allclose(
            now.acceleration[2], (after.velocity[2] - before.velocity[2]) / (2 * STEP), atol=1e-6
        )


def test_it_lands_as_high_as_the_ground_is():
    stride = Stride(START, np.eye(3), LIFT, LAND, HEIGHT, ground=0.3)
    assert stride(LAND).position[2] == pytest.approx(0.3 - LANDING_DEPTH)
    assert stride(LIFT).position[2] == pytest.approx(START[2])


def test_a_foot_that_turns_turns_about_the_vertical_and_its_velocity_is_the_derivative():
    stride = Stride(START, np.eye(3), LIFT, LAND, HEIGHT)
    stride.redirect(LIFT, TO, turn=0.4)
    end = stride(LAND).rotation
    np.testing.assert_allclose(end[:2, 0], [np.cos(0.4), np.sin(0.4)], atol=1e-9)
    for t in (0.6, 0.7):
        before, after = (np.arctan2(*stride(t + d).rotation[1::-1, 0]) for d in (-STEP, STEP))
        assert stride(t).velocity[5] == pytest.approx((after - before) / (2 * STEP), abs=1e-6)


def test_the_curve_of_the_bump_is_its_second_derivative():
    shares, h = np.linspace(0.05, 0.95, 19), 1e-4
    numeric = (bump(shares + h) - 2.0 * bump(shares) + bump(shares - h)) / h**2
    np.testing.assert_allclose(bump_curve(shares), numeric, atol=1e-5)
    assert bump(0.5) == pytest.approx(1.0)


def test_the_greatest_curvature_of_the_bump_upward_is_what_is_said():
    shares = np.linspace(0.0, 1.0, 1001)
    assert np.max(bump_curve(shares)) == pytest.approx(BUMP_CURVATURE, rel=1e-3)
