"""Relative motion of two surfaces against differences along a motion of robot, box and door."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots import FLOOR, Robot, Surface, System, Thing

PAIRS = (
    ("right_palm", "box/right"),
    ("left_foot", "floor"),
    ("left_hand_end", "door/front"),
    ("box/bottom", "table/top"),
    ("box/left", "door/back"),
    ("left_palm", "right_palm"),
)


@pytest.fixture(scope="module")
def system():
    robot = Robot.load("hrp2")
    tilted = pin.SE3(pin.rpy.rpyToMatrix(0.3, 0.2, -0.4), np.array([0.5, 0.2, 0.9]))
    things = [Thing.load("box", placement=tilted), Thing.load("door", placement=tilted), Thing.load("table")]
    return System(robot, things)


def moving_state(system, seed):
    rng = np.random.default_rng(seed)
    return pin.integrate(system.model, system.rest, rng.uniform(-0.4, 0.4, system.nv)), rng.uniform(-1, 1, system.nv)


def at(tick, point):
    frame = tick.frame(point)
    return frame.rotation.copy(), frame.position.copy()


@pytest.mark.parametrize("names", PAIRS, ids=lambda names: " on ".join(names))
def test_velocity_jacobian_and_drift_are_derivatives(system, names):
    """ẋ_rel = v_a − v_b at one material point; its derivative at constant v is J̇_rel v, Otani (15)."""
    surface, on = (system.surface(name) for name in names)
    tick, (q, v), step = Tick(system), moving_state(system, 3), 1e-5
    tick.update(0.0, q, v)
    motion = tick.relative_frame(surface, on)
    velocity, drift, J = motion.velocity.copy(), motion.drift.copy(), motion.jacobian.copy()
    np.testing.assert_allclose(J @ v, velocity, atol=1e-12)

    def places(q):
        tick.update(0.0, q, v)
        own = pin.SE3(*at(tick, surface.point))
        return own, pin.SE3.Identity() if on.point is None else pin.SE3(*at(tick, on.point))

    own, other = places(q)
    origin = own.act(surface.placement.translation)
    fixed_a, fixed_b = own.actInv(origin), other.actInv(origin)  # the material points that meet now

    def point_velocities(q):
        tick.update(0.0, q, v)
        out = []
        for point, fixed in ((surface.point, fixed_a), (on.point, fixed_b)):
            if point is None:
                out.append(np.zeros(6))
                continue
            frame = tick.frame(point)
            turning = np.cross(frame.velocity[3:], frame.rotation @ fixed)
            out.append(np.concatenate([frame.velocity[:3] + turning, frame.velocity[3:]]))
        return out[0] - out[1]

    before, after = (pin.integrate(system.model, q, sign * step * v) for sign in (-1.0, 1.0))
    (own_0, other_0), (own_1, other_1) = places(before), places(after)
    by_differences = (
        (own_1.act(fixed_a) - own_0.act(fixed_a) - other_1.act(fixed_b) + other_0.act(fixed_b)) / step / 2.0
    )
    np.testing.assert_allclose(velocity[:3], by_differences, atol=1e-7)
    spin = pin.log3(own_1.rotation @ own_0.rotation.T) - pin.log3(other_1.rotation @ other_0.rotation.T)
    np.testing.assert_allclose(velocity[3:], spin / step / 2.0, atol=1e-7)
    rates = (point_velocities(after) - point_velocities(before)) / (2.0 * step)
    np.testing.assert_allclose(drift, rates, atol=1e-6)


def test_a_sole_on_the_floor_is_the_foots_frame_itself(system):
    tick = Tick(system)
    assert tick.relative_frame(system.surface("left_foot"), FLOOR) is tick.frame("left_foot")


def test_surfaces_of_one_body_are_refused(system):
    tick, robot = Tick(system), system.robot
    elbow = Surface.of_corners("elbow", [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]], point="right_wrist")
    other = Surface.of_corners("pad", [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]], point="left_foot")
    with pytest.raises(InputError, match=r"'pad on left_foot'.* one body"):
        tick.relative_frame(other, robot.surface("left_foot"))
    assert tick.relative_frame(elbow, robot.surface("left_foot")).jacobian.shape == (6, system.nv)
