"""The bias h of the equation of motion with what joints lose, and the centre of mass that falls out beside it."""

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.gravity import GRAVITY
from sot.robots.robot import Robot

Array = np.ndarray

COULOMB_SPEED = 0.1
"""Least joint speed [rad/s] over which the Coulomb friction that is compensated changes sign: a step would chatter."""
COMPENSATION_RATE_LIMIT = 100.0
"""Bound of the rate [1/s] at which compensated friction speeds a joint up that has none: where the joint is light, the
compensation changes sign over a larger speed."""


def coulomb_speeds(robot: Robot) -> Array:
    """Speeds over which each joint's compensated Coulomb friction changes sign, shape (na,) [rad/s].

    The compensation f tanh(v / s) adds at most f / s to a speed's rate over its inertia, f / (s I). Were the joint's
    friction less than the model's, that would be positive feedback: s bounds it. I is the least inertia that the joint
    can feel, 1 / (M⁻¹)ᵢᵢ, all others left free, at rest.
    """
    M = pin.crba(robot.model, robot.model.createData(), robot.rest)
    M = np.triu(M) + np.triu(M, 1).T
    inertias = 1.0 / np.diag(np.linalg.inv(M))[6:]
    return np.maximum(COULOMB_SPEED, robot.friction / (COMPENSATION_RATE_LIMIT * inertias))


@compiled
def write_bias_and_com(
    forces: Array,
    base: Array,
    A_g: Array,
    mass: float,
    v: Array,
    losses: Array,
    h: Array,
    com_jacobian: Array,
    com_velocity: Array,
    com_drift: Array,
    momentum: Array,
) -> bool:
    """Write h with joint losses, the CoM's Jacobian, velocity and drift, and the momentum about it.

    From Pinocchio's forces and A_g, which may be another's in a system of robot and things, and the joints' damping,
    friction and the speeds over which that changes sign, `losses` (3, na).

    Returns:
        Whether the state that these come from is finite: one value of it that is not makes a sum of them so.
    """
    h[:] = forces
    total = 0.0
    for k in range(losses.shape[1]):
        h[6 + k] += losses[0, k] * v[6 + k] + losses[1, k] * np.tanh(v[6 + k] / losses[2, k])
    for i in range(6):
        momentum[i] = 0.0
    for k in range(len(v)):  # column by column, as A_g lies in memory
        for i in range(3):
            com_jacobian[i, k] = A_g[i, k] / mass
        for i in range(6):
            momentum[i] += A_g[i, k] * v[k]
    for i in range(3):
        com_velocity[i] = momentum[i] / mass
        # The force on the base that lets nothing accelerate but by J̇ v.
        com_drift[i] = (base[i, 0] * forces[0] + base[i, 1] * forces[1] + base[i, 2] * forces[2]) / mass
        total += com_velocity[i] + com_drift[i]
    com_drift[2] -= GRAVITY
    for k in range(len(h)):
        total += h[k]
    return bool(np.isfinite(total))


@compiled
def add_joint_forces(
    h: Array,
    positions: Array,
    v: Array,
    start: int,
    stiffness: Array,
    reference: Array,
    damping: Array,
    friction: Array,
) -> None:
    """Add to h what springs, dampers and friction of the things' joints take; their velocities begin at `start`."""
    for k in range(len(stiffness)):
        speed = v[start + k]
        h[start + k] += stiffness[k] * (positions[k] - reference[k]) + damping[k] * speed
        h[start + k] += friction[k] * np.tanh(speed / COULOMB_SPEED)
