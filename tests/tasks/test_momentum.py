"""Angular momentum as a task."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.tick import Tick
from sot.robots.robot import Robot, shipped_robot_names
from tasks import AngularMomentum
from tests.sot.states import random_state
from tests.tasks.checks import followed


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


@pytest.mark.parametrize("seed", range(3))
def test_an_acceleration_that_keeps_the_rows_changes_the_momentum_as_wanted(robot, seed):
    """Jacobian and drift at once: along a motion of that acceleration, L changes by finite differences as L̇*."""
    rng = np.random.default_rng(seed)
    q, v = random_state(robot, rng)
    tick, model, step = Tick(robot), robot.model, 1e-5
    wanted, rate = rng.uniform(-5, 5, 3), rng.uniform(-5, 5, 3)
    task = AngularMomentum(lambda t: (wanted, rate), k=3.0)
    rows = task.rows(tick.update(0.0, q, v))
    momentum = tick.centroidal()[0][3:].copy()
    np.testing.assert_allclose(task.error, wanted - momentum)
    some = rng.uniform(-5, 5, robot.nv)
    acceleration = some + np.linalg.lstsq(rows.A, rows.lower - rows.A @ some, rcond=None)[0]

    def at(time):
        moved = pin.integrate(model, q, time * v + 0.5 * time**2 * acceleration)
        return tick.update(0.0, moved, v + time * acceleration).centroidal()[0][3:].copy()

    np.testing.assert_allclose((at(step) - at(-step)) / (2 * step), rate + 3.0 * (wanted - momentum), atol=1e-4)


def test_without_a_reference_the_spin_is_damped_at_the_rate_k(robot):
    q, v = random_state(robot, np.random.default_rng(3), spread=0.3, speed=0.5)
    errors = followed(AngularMomentum(k=5.0), robot, q, v, 0.6, 0.001)
    assert np.linalg.norm(errors[0]) > 0.5
    np.testing.assert_allclose(errors[-1], np.exp(-5.0 * 0.6) * errors[0], atol=0.02 * np.linalg.norm(errors[0]))
