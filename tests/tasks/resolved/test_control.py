"""Resolved acceleration: its rows, (31) to the letter, and limits that hold where the printed weights run away."""

import coal
import numpy as np
import pinocchio as pin
import pytest

from solvers import ResolvedAcceleration, damped_inverse
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.control import ConstrainedResolvedAcceleration, towards_rest
from tasks.resolved.pairs import NearestPairs, Obstacle
from tasks.resolved.points import PointsSample, ResolvedPoints
from tasks.resolved.weighting import (
    DynamicOnly,
    MendedWeighting,
    PrintedWeighting,
    Weighting,
    inertia_weight,
    unit_weight,
)
from tests.sot.states import random_state
from tests.tasks.checks import assert_jacobian_and_drift

PERIOD, GAIN = 0.01, 30.0
RUNAWAY_SPEED = 100.0


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def standing_feet(robot, tick, gain=GAIN):
    places = [tick.frame(foot) for foot in robot.feet]
    sample = PointsSample(
        np.array([place.position for place in places]),
        np.zeros((2, 6)),
        np.zeros((2, 6)),
        np.array([place.rotation for place in places]),
    )
    return ResolvedPoints(robot, robot.feet, lambda t: sample, velocity_gain=gain)


def wrist_to(robot, target, gain=GAIN):
    sample = PointsSample(np.array([robot.rest[:3], target]), np.zeros((2, 3)), np.zeros((2, 3)))
    return ResolvedPoints(robot, ["waist", "right_wrist"], lambda t: sample, velocity_gain=gain)


def test_rows_have_the_points_jacobian_and_drift(robot):
    q, v = random_state(robot, np.random.default_rng(1), 0.3)
    tick = Tick(robot)
    assert_jacobian_and_drift(wrist_to(robot, np.array([0.3, -0.2, 1.0])), tick, q, v)
    rates = [standing_feet(robot, tick).observe(tick.update(0.0, q, v))[index] for index in (1, 2)]
    np.testing.assert_allclose(rates[0], -rates[1] @ v, atol=1e-9)


def test_one_inverse_of_both_right_hand_sides_is_hammam_31(robot):
    q, v = random_state(robot, np.random.default_rng(2), 0.2)
    tick = Tick(robot).update(0.0, q, v)
    feet, points = standing_feet(robot, tick), wrist_to(robot, np.array([0.4, -0.2, 1.0]))
    solver = ResolvedAcceleration((0.1,), exact_projectors=False)
    control = ConstrainedResolvedAcceleration(
        [feet, points], NearestPairs(robot, 16, 0.2), DynamicOnly(inertia_weight), solver
    )
    found = control(tick)

    def parts(task):
        error, rate, J, drift, forward = (np.array(part) for part in task.observe(tick))
        acceleration = forward + task.kd * rate + task.kp * error - drift  # (11)
        return J, acceleration, rate + J @ v + task.velocity_kp * error  # (15)

    (Jf, af, vf), (Ju, au, vu) = parts(feet), parts(points)
    inverse = damped_inverse(Jf, 0.1, tick.M)
    reduced = Ju @ (np.eye(robot.nv) - inverse @ Jf)
    lower = damped_inverse(reduced, 0.1, tick.M)
    alpha = inverse @ af + lower @ (au - Ju @ inverse @ af)  # (34)-(39)
    velocity = inverse @ vf + lower @ (vu - Ju @ inverse @ vf)  # (41)
    np.testing.assert_allclose(found, alpha + GAIN * (velocity - v), rtol=1e-6, atol=1e-6)


def follow(robot, weighting: Weighting, target, seconds=2.0, damping=(0.03, 0.1), exact=True, gain=GAIN, obstacles=()):
    """Configurations (T, nq) and distances of the nearest pair (T,) on the way of a wrist to a target."""
    tick, q, v = Tick(robot, PERIOD), robot.rest.copy(), np.zeros(robot.nv)
    levels = [standing_feet(robot, tick, gain), wrist_to(robot, target, gain)]
    control = ConstrainedResolvedAcceleration(
        levels, NearestPairs(robot, 16, 0.2, 1.0 / gain, obstacles), weighting, ResolvedAcceleration(damping, exact)
    )
    way, nearest = [], []
    for k in range(round(seconds / PERIOD)):
        answer = control(tick.update(k * PERIOD, q, v))
        way.append(q)
        nearest.append(control.distances.values.min(initial=np.inf))
        if np.isfinite(gain):
            q, v = pin.integrate(robot.model, q, PERIOD * v + 0.5 * PERIOD**2 * answer), v + PERIOD * answer
        else:
            q, v = pin.integrate(robot.model, q, PERIOD * answer), answer
        if not np.abs(v).max() < RUNAWAY_SPEED:
            break
    return np.array(way), np.array(nearest)


def beyond(robot, way):
    return max(float((way[:, 7:] - robot.upper).max()), float((robot.lower - way[:, 7:]).max()))


OUT_OF_REACH, INTO_THE_CHEST = np.array([1.0, -0.5, 1.4]), np.array([0.0, 0.1, 0.9])


@pytest.mark.parametrize("target", [OUT_OF_REACH, INTO_THE_CHEST])
@pytest.mark.parametrize("gain", [GAIN, np.inf])
def test_mended_weights_keep_ranges_and_distances(robot, target, gain):
    way, nearest = follow(robot, MendedWeighting(robot, unit_weight, gain), target, gain=gain)
    assert beyond(robot, way) < 0.0 < nearest.min()


def test_mended_weights_keep_away_from_an_obstacle(robot):
    wall = Obstacle("wall", coal.Box(0.02, 4.0, 4.0), pin.SE3(np.eye(3), np.array([0.45, 0.0, 0.9])))
    target = np.array([0.52, -0.25, 1.0])
    nearest = {
        name: follow(robot, weighting, target, obstacles=[wall])[1].min()
        for name, weighting in (("free", DynamicOnly(unit_weight)), ("kept", MendedWeighting(robot, unit_weight, GAIN)))
    }
    assert nearest["free"] < -0.02 and nearest["kept"] > 0.0


def test_what_the_points_leave_free_goes_to_rest(robot):
    tick, q = Tick(robot, PERIOD), robot.rest.copy()
    elbow = robot.groups["left_arm"][3]
    q[7 + elbow] -= 0.5
    levels, v = (
        [standing_feet(robot, tick), wrist_to(robot, tick.frame("right_wrist").position.copy())],
        np.zeros(robot.nv),
    )
    control = ConstrainedResolvedAcceleration(
        levels,
        NearestPairs(robot, 16, 0.2),
        MendedWeighting(robot, unit_weight, GAIN),
        ResolvedAcceleration((0.03, 0.1)),
        towards_rest(robot, 5.0, GAIN),
    )
    for k in range(150):
        answer = control(tick.update(k * PERIOD, q, v))
        q, v = pin.integrate(robot.model, q, PERIOD * v + 0.5 * PERIOD**2 * answer), v + PERIOD * answer
    assert abs(q[7 + elbow] - robot.rest[7 + elbow]) < 0.02 and control.levels[1].distances.max() < 0.01


def test_without_weights_the_same_targets_violate_both(robot):
    way, _ = follow(robot, DynamicOnly(unit_weight), OUT_OF_REACH)
    _, nearest = follow(robot, DynamicOnly(unit_weight), INTO_THE_CHEST)
    assert beyond(robot, way) > 0.1 and nearest.min() < -0.01


def test_printed_weights_let_joints_out(robot):
    way, _ = follow(robot, PrintedWeighting(robot, inertia_weight), OUT_OF_REACH, damping=(0.1,), exact=False)
    assert beyond(robot, way) > 0.1


def test_who_starts_beyond_a_limit_is_led_back(robot):
    out = robot.rest.copy()
    elbow = robot.joints.index("RARM3") if "RARM3" in robot.joints else robot.groups["right_arm"][3]
    out[7 + elbow] = robot.upper[elbow] + 0.2
    tick, q, v = Tick(robot, PERIOD), out, np.zeros(robot.nv)
    levels = [standing_feet(robot, tick)]
    control = ConstrainedResolvedAcceleration(
        levels, NearestPairs(robot, 16, 0.2), MendedWeighting(robot, unit_weight, GAIN), ResolvedAcceleration((0.03,))
    )
    for k in range(200):
        answer = control(tick.update(k * PERIOD, q, v))
        q, v = pin.integrate(robot.model, q, PERIOD * v + 0.5 * PERIOD**2 * answer), v + PERIOD * answer
    assert q[7 + elbow] < robot.upper[elbow]
