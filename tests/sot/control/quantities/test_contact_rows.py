"""The acceleration of a surface that turns about its front edge, against differences of the motion itself."""

import numpy as np
import pinocchio as pin

from sot.control.quantities.contact_rows import rolling_acceleration

EDGE = np.array([0.13, 0.0, 0.0])
HEADING, PLACE = 0.7, np.array([0.4, -0.2, 0.0])
STIFFNESS, DAMPING = 100.0, 20.0
STEP = 1e-4
PITCH = np.array([0.0, 1.0, 0.0])


def angle(t):
    return 0.4 * np.sin(2.0 * t) ** 2


def reference(t):
    """Rotation, velocity and acceleration of a body that turns, somewhere else and facing elsewhere."""
    turn = pin.utils.rotate("z", 0.5) @ pin.exp3(angle(t) * PITCH)
    rate = 0.8 * np.sin(4.0 * t)
    bend = 3.2 * np.cos(4.0 * t)
    return turn, np.append(np.zeros(3), rate * turn[:, 1]), np.append(np.zeros(3), bend * turn[:, 1])


def pose(t):
    """Place and rotation of a surface that rolls over its edge as the reference turns."""
    flat = pin.utils.rotate("z", HEADING)
    rotation = flat @ pin.exp3(angle(t) * PITCH)
    return PLACE + flat @ EDGE - rotation @ EDGE, rotation


def velocity(t):
    (before, turned), (after, turning) = pose(t - STEP), pose(t + STEP)
    return np.append((after - before) / (2.0 * STEP), pin.log3(turning @ turned.T) / (2.0 * STEP))


def asked(place, rotation, moving, t):
    return rolling_acceleration(
        place, rotation, moving, np.zeros(3), np.eye(3), STIFFNESS, DAMPING, EDGE, *reference(t)
    )


def test_a_surface_on_its_way_is_asked_for_the_way_s_own_acceleration():
    for t in (0.1, 0.35, 0.6):
        expected = (velocity(t + STEP) - velocity(t - STEP)) / (2.0 * STEP)
        np.testing.assert_allclose(asked(*pose(t), velocity(t), t), expected, atol=1e-5)


def test_a_surface_beside_its_way_comes_back_to_it():
    """From 8 mm above the floor and 0.1 rad off, at rest."""
    period, (place, rotation) = 1e-3, pose(0.0)
    place, rotation, moving = (
        place + 0.008 * np.array([0.0, 0.0, 1.0]),
        pin.exp3(np.array([0.1, 0.05, 0.0])) @ rotation,
        np.zeros(6),
    )
    for k in range(1500):
        moving = moving + period * asked(place, rotation, moving, k * period)
        place, rotation = place + period * moving[:3], pin.exp3(period * moving[3:]) @ rotation
    edge = place + rotation @ EDGE
    assert abs(edge[2]) < 1e-4
    assert np.arcsin(-rotation[2, 0]) == np.clip(np.arcsin(-rotation[2, 0]), angle(1.5) - 5e-3, angle(1.5) + 5e-3)
    assert abs(rotation[2, 1]) < 1e-3
