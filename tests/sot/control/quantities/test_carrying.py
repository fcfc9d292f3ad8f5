"""Centre of mass and momentum of the robot and what it carries: against sums over bodies and differences."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots import Robot, System, Thing


@pytest.fixture(scope="module")
def system():
    boxes = [
        Thing.load("box", name=name, placement=(0.4, y, 0.9), mass=m) for name, y, m in (("a", 0.3, 4), ("b", -0.3, 7))
    ]
    return System(Robot.load("hrp2"), [*boxes, Thing.load("door", placement=(1.0, 0.4, 0.0))])


def moving_state(system, seed=1):
    rng = np.random.default_rng(seed)
    return pin.integrate(system.model, system.rest, rng.uniform(-0.4, 0.4, system.nv)), rng.uniform(-1, 1, system.nv)


def sums(system, q, v, things):
    """Mass, centre of mass and momentum about it by summing over the bodies of the robot and of some things."""
    model, data = system.model, system.model.createData()
    pin.forwardKinematics(model, data, q, v)
    roots = {1, *(model.getJointId(f"{thing}/free") for thing in things)}
    joints = [j for j in range(1, model.njoints) if model.supports[j][1] in roots]
    masses = np.array([model.inertias[j].mass for j in joints])
    coms = np.array([data.oMi[j].act(model.inertias[j].lever) for j in joints])
    com = masses @ coms / masses.sum()
    momentum = sum((data.oMi[j].act(model.inertias[j] * data.v[j]) for j in joints), pin.Force.Zero())
    shifted = pin.SE3(np.eye(3), com).actInv(momentum)
    return masses.sum(), com, shifted.vector


@pytest.mark.parametrize("things", [(), ("b",), ("a", "b")], ids=str)
def test_what_is_carried_counts_and_nothing_else(system, things):
    q, v = moving_state(system)
    tick = Tick(system)
    tick.carried = things
    tick.update(0.0, q, v)
    mass, com, momentum = sums(system, q, v, things)
    assert tick.mass == pytest.approx(mass)
    np.testing.assert_allclose(tick.com, com, atol=1e-12)
    np.testing.assert_allclose(tick.momentum, momentum, atol=1e-9)
    np.testing.assert_allclose(tick.com_jacobian @ v, tick.com_velocity, atol=1e-12)
    np.testing.assert_allclose(tick.com_velocity, momentum[:3] / mass, atol=1e-12)


@pytest.mark.parametrize("things", [(), ("a", "b")], ids=str)
def test_drifts_are_derivatives_at_constant_velocity(system, things):
    (q, v), step, tick = moving_state(system), 1e-5, Tick(system)
    tick.carried = things
    tick.update(0.0, q, v)
    drift, (_, matrix, rate), velocity = tick.com_drift.copy(), tick.centroidal(), tick.com_velocity.copy()
    matrix, rate = matrix.copy(), rate.copy()
    after = tick.update(0.0, pin.integrate(system.model, q, step * v), v)
    com, later, momentum = after.com.copy(), after.com_velocity.copy(), after.momentum.copy()
    before = tick.update(0.0, pin.integrate(system.model, q, -step * v), v)
    np.testing.assert_allclose((com - before.com) / (2 * step), velocity, atol=1e-7)
    np.testing.assert_allclose((later - before.com_velocity) / (2 * step), drift, atol=1e-6)
    np.testing.assert_allclose((momentum - before.momentum) / (2 * step), rate, atol=1e-4)
    tick.update(0.0, q, v)
    np.testing.assert_allclose(matrix @ v, tick.momentum, atol=1e-9)


def test_a_robot_that_carries_nothing_is_as_it_is_alone(system):
    q, v = moving_state(system)
    robot = system.robot
    alone, among = Tick(robot), Tick(system)
    alone.update(0.0, q[: robot.nq], v[: robot.nv])
    among.update(0.0, q, v)
    np.testing.assert_allclose(among.com, alone.com, atol=1e-12)
    np.testing.assert_allclose(among.com_drift, alone.com_drift, atol=1e-9)
    np.testing.assert_allclose(among.h[: robot.nv], alone.h, atol=1e-9)
    np.testing.assert_allclose(among.centroidal()[2], alone.centroidal()[2], atol=1e-8)


@pytest.mark.parametrize(("name", "message"), [("door", "fixed to the world"), ("lid", "no thing 'lid'")])
def test_only_free_things_can_be_carried(system, name, message):
    with pytest.raises(InputError, match=message):
        Tick(system).carried = (name,)
