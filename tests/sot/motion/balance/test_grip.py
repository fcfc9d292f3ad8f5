import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import linprog

from sot.motion.balance.centroidal import Centroidal, momentum_maps
from sot.motion.balance.grip import RELIED_FRICTION, USED_FRICTION_SHARE, Grip, yaw_moment_range
from sot.motion.body.coordinates import from_configuration, to_pinocchio
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import Phase, planted_phases
from sot.robots.robot import Robot

PERIOD = 0.02
HALF = np.array([0.11, 0.06])


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def twist(robot):
    """The chest turns to and fro at rest, more and more."""
    t = PERIOD * np.arange(60)
    y = np.tile(from_configuration(robot.rest[None]), (len(t), 1))
    y[:, 6 + robot.groups["chest"][0]] += 0.3 * (t / t[-1]) ** 3 * np.sin(12.0 * t)
    return Spline.through(y, PERIOD)


def centroidal(robot, spline):
    return Centroidal.along(robot, *to_pinocchio(spline.knots, spline.velocities, spline.accelerations))


def test_momentum_is_its_map_times_the_rates_of_the_coordinates(robot):
    rng = np.random.default_rng(0)
    y = from_configuration(robot.rest[None]) + 0.3 * rng.standard_normal((4, robot.nv))
    rates = rng.standard_normal((4, robot.nv))
    momentum = Centroidal.along(robot, *to_pinocchio(y, rates, np.zeros_like(rates))).momentum
    np.testing.assert_allclose(np.einsum("tij,tj->ti", momentum_maps(robot, y), rates), momentum, atol=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_yaw_moments_are_what_forces_at_the_corners_can_give(seed):
    rng = np.random.default_rng(seed)
    normal = 500.0
    force = np.array([*(0.4 * RELIED_FRICTION * normal * rng.uniform(-1, 1, 2)), normal])
    place = 0.7 * HALF * rng.uniform(-1, 1, 2)
    moment = np.array([place[1] * normal, -place[0] * normal, 0.0])
    corners = np.array([(x, y, 0.0) for x in (HALF[0], -HALF[0]) for y in (HALF[1], -HALF[1])])
    wrench = np.vstack([np.tile(np.eye(3), 4), np.hstack([pin.skew(corner) for corner in corners])])
    pyramid = np.kron(np.eye(4), [[s * (a == 0), s * (a == 1), -RELIED_FRICTION] for a in (0, 1) for s in (1, -1)])
    ends = [
        linprog(
            sign * wrench[5],
            pyramid,
            np.zeros(16),
            wrench[:5],
            np.concatenate([force, moment[:2]]),
            bounds=[(None, None)] * 12,
        ).fun
        for sign in (1.0, -1.0)
    ]
    least, most = yaw_moment_range(force[None], moment[None], HALF)
    np.testing.assert_allclose([least[0], -most[0]], ends, atol=1e-6)


def test_what_a_foot_cannot_hold_is_told_with_the_accelerations_that_change_it(robot, twist):
    (both,) = planted_phases(robot, 1.2)
    alone = Phase(0.0, 1.2, {"left_foot": both.feet["left_foot"]})
    times = PERIOD * np.arange(60)
    y, state = twist.knots, centroidal(robot, twist)
    assert not Grip(robot, [both], times).excess(y, state)[0][:, 0].any()
    grip = Grip(robot, [alone], times)
    errors, jacobians = grip.excess(y, state)
    over = np.flatnonzero(errors[:, 0])
    assert len(over) and len(over) < 60
    np.testing.assert_array_equal(np.flatnonzero(jacobians[:, 0].any(axis=1)), over)

    # so much less of the accelerations along their own Jacobian leaves the error's own moment less
    k = int(over[np.abs(errors[over, 0]).argmax()])
    J = jacobians[k, 0]
    accelerations = twist.accelerations.copy()
    accelerations[k] -= J * errors[k, 0] / (J @ J)
    mended = Centroidal.along(robot, *to_pinocchio(y, twist.velocities, accelerations))
    before, after = (s.rate[k, 5] for s in (state, mended))
    assert grip.weights[0] * (before - after) == pytest.approx(errors[k, 0], rel=1e-6)
    assert USED_FRICTION_SHARE < 1.0
