"""The centre of mass as a task."""

import numpy as np
import pytest

from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot, shipped_robot_names
from tasks import CenterOfMass
from tests.sot.states import random_state
from tests.tasks.checks import assert_jacobian_and_drift, followed


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


@pytest.mark.parametrize(("axes", "selected"), [("xyz", [0, 1, 2]), ("xy", [0, 1]), ("zx", [0, 2])])
def test_jacobian_drift_and_axes(robot, axes, selected):
    rng, tick = np.random.default_rng(0), Tick(robot)
    task = CenterOfMass(np.array([0.3, -0.2, 0.7]), axes)
    q, v = random_state(robot, rng)
    assert_jacobian_and_drift(task, tick, q, v)
    tick.update(0.0, q, v)
    np.testing.assert_array_equal(task.rows(tick).A, tick.com_jacobian[selected])
    np.testing.assert_allclose(task.error, (np.array([0.3, -0.2, 0.7]) - tick.com)[selected])


def test_rows_are_the_wanted_acceleration(robot):
    tick = Tick(robot).update(0.3, *random_state(robot, np.random.default_rng(1)))
    offset, faster, acceleration = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, -3.0]), np.array([4.0, 5.0, 6.0])
    asked = []

    def reference(t):
        asked.append(t)
        return tick.com + offset, tick.com_velocity + faster, acceleration

    rows = CenterOfMass(reference, kp=20.0).rows(tick)
    wanted = acceleration + 20.0 * offset + 2.0 * np.sqrt(20.0) * faster
    np.testing.assert_allclose(rows.lower + tick.com_drift, wanted)
    np.testing.assert_array_equal(rows.lower, rows.upper)
    assert asked == [0.3]


def test_a_target_is_reached(robot):
    q, v = random_state(robot, np.random.default_rng(2))
    errors = followed(CenterOfMass(np.array([0.5, 0.5, 0.5])), robot, q, v, 1.5, 0.01)
    assert np.linalg.norm(errors[0]) > 0.1
    assert np.linalg.norm(errors[-1]) < 1e-3


def test_wrong_axes_are_refused():
    for axes in ("", "xx", "xR"):
        with pytest.raises(InputError, match=f"axes '{axes}' of CenterOfMass: choose some of xyz"):
            CenterOfMass(np.zeros(3), axes)
