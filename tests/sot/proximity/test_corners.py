"""A box that tips over a table: the corner that comes down has a distance of its own before it is the nearest."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.tick import Tick
from sot.proximity import Proximity
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.robots.things.thing import Thing

PERIOD, HORIZON, LEAST = 0.002, 0.03, 0.01
TOP, GAP, SIZE = 0.8, 0.02, np.array([0.25, 0.3, 0.2])


@pytest.fixture(scope="module")
def system() -> System:
    table = Thing.load("table", placement=(0.8, 0.0, 0.0), size=(0.8, 1.0, TOP))
    return System(Robot.load("hrp2"), [Thing.load("box", size=tuple(SIZE)), table])


def tipping(system: System, tilt: float, about: float) -> tuple[np.ndarray, np.ndarray]:
    """A box above the table, an edge down by a tilt [rad], that turns about the edge's direction [rad/s] and sinks."""
    q, v = system.rest.copy(), np.zeros(system.nv)
    turned = pin.Quaternion(pin.utils.rotate("y", tilt) @ pin.utils.rotate("x", 0.002)).coeffs()
    q[system.coordinates["box"]] = [0.8, 0.0, TOP + 0.5 * SIZE[2] + GAP, *turned]
    v[system.velocities["box"]] = [0.0, 0.0, -0.05, 0.02, about, 0.0]
    return q, v


def told(system: System, q: np.ndarray, v: np.ndarray, proximity: Proximity | None = None):
    proximity, tick = proximity or Proximity(system), Tick(system)
    pair = np.array([proximity.pairs.index(("box/box", "table/block"))])
    proximity.move_to(tick.update(0.0, q, v).data)
    nearest = proximity.motion(pair, v, PERIOD)
    return proximity, nearest, proximity.second_corners(pair, v, PERIOD, HORIZON, LEAST)


def corner_heights(system: System, q: np.ndarray) -> np.ndarray:
    """Of the box's lower corners over the table (4,) [m]."""
    at = q[system.coordinates["box"]]
    corners = 0.5 * SIZE * [[1, 1, -1], [1, -1, -1], [-1, 1, -1], [-1, -1, -1]]
    return (corners @ pin.Quaternion(at[3:]).matrix().T + at[:3])[:, 2] - TOP


def test_the_corner_that_comes_down_moves_as_it_does_by_differences(system: System) -> None:
    q, v = tipping(system, 0.004, -1.5)
    _, nearest, (pairs, second) = told(system, q, v)
    heights = corner_heights(system, q)
    assert nearest.distances[0] == pytest.approx(heights.min(), abs=1e-6)
    (k,) = np.flatnonzero(np.abs(heights - second.distances[0]) < 1e-6)
    assert len(pairs) == 1 and k != heights.argmin()
    step = 1e-4
    before, after = (corner_heights(system, pin.integrate(system.model, q, sign * step * v))[k] for sign in (-1.0, 1.0))
    assert second.rates[0] == pytest.approx((after - before) / (2.0 * step), abs=1e-5)
    assert second.rates[0] < nearest.rates[0] - 0.1
    ahead = corner_heights(system, pin.integrate(system.model, q, PERIOD * v))[k]
    twice = corner_heights(system, pin.integrate(system.model, q, 2.0 * PERIOD * v))[k]
    assert second.drifts[0] == pytest.approx((twice - 2.0 * ahead + heights[k]) / PERIOD**2, abs=0.02)


def test_no_acceleration_comes_from_a_jump_to_another_corner(system: System) -> None:
    """The nearest corner changes within the next period: J̇ v stays that of the one that is the nearest now."""
    q, v = tipping(system, 0.0005, -1.5)
    _, nearest, _ = told(system, q, v)
    now, k = corner_heights(system, q), corner_heights(system, q).argmin()
    ahead, twice = (corner_heights(system, pin.integrate(system.model, q, n * PERIOD * v)) for n in (1, 2))
    assert ahead.argmin() != k
    assert nearest.drifts[0] == pytest.approx((twice[k] - 2.0 * ahead[k] + now[k]) / PERIOD**2, abs=0.1)


def test_the_corner_that_was_the_nearest_is_remembered(system: System) -> None:
    q, v = tipping(system, 0.0005, -1.5)
    proximity, _, _ = told(system, q, v)
    still = np.zeros(system.nv)
    over = pin.integrate(system.model, q, 2.0 * PERIOD * v)
    _, nearest, (pairs, second) = told(system, over, still, proximity)
    heights = np.sort(corner_heights(system, over))
    assert len(pairs) == 1 and heights[0] == pytest.approx(nearest.distances[0], abs=1e-6)
    assert second.distances[0] == pytest.approx(
        corner_heights(system, over)[corner_heights(system, q).argmin()], abs=1e-6
    )
    for other in (None, proximity):
        proximity.forget_corners()
        _, _, (alone, _) = told(system, over, still, other)
        assert not len(alone)


def test_a_corner_that_is_far_from_the_other_shape_has_no_row(system: System) -> None:
    q, v = tipping(system, 0.1, -0.5)
    _, _, (pairs, _) = told(system, q, v)
    assert not len(pairs)
