"""The invariant filter's arithmetic: a rigid body with an inertial unit, and feet that stand (Hartley 2020).

The error of a belief X̂ is right-invariant, in world axes: X = Exp(ξ) X̂ for the body's rotation, velocity and position
and the feet's positions together, C = Exp(ξ_C) Ĉ for each foot's rotation, and a plain difference for the biases. So a
foot that is seen from the body gives rows that do not depend on the belief, and what cannot be observed, place and
heading, stays unobserved.
"""

from typing import NamedTuple

import numpy as np

from solvers.compiled import compiled
from sot.rotation import cross, rotation_of_vector, rotation_vector

Array = np.ndarray

ROTATION, VELOCITY, POSITION, GYRO_BIAS, ACCELEROMETER_BIAS, FEET = 0, 3, 6, 9, 12, 15
"""Where the parts of the error start; each foot has six more, its position before its rotation."""
FOOT = 6


class Belief(NamedTuple):
    """What the filter believes, arrays that are written in place.

    Args:
        rotation: Of the inertial unit's frame in the world (3, 3).
        velocity, position: Of its origin, world axes (3,) [m/s, m].
        gyro_bias, accelerometer_bias: In its frame (3,) [rad/s, m/s²].
        foot_position, foot_rotation: Of the soles that stand (feet, 3) and (feet, 3, 3).
        covariance: Of the error, shape (15 + 6 feet, 15 + 6 feet).
    """

    rotation: Array
    velocity: Array
    position: Array
    gyro_bias: Array
    accelerometer_bias: Array
    foot_position: Array
    foot_rotation: Array
    covariance: Array

    @staticmethod
    def empty(feet: int) -> "Belief":
        """At the world's origin, certain of everything."""
        size = FEET + FOOT * feet
        turns = np.stack([np.eye(3)] * feet)
        velocity, position, gyro_bias, accelerometer_bias = np.zeros((4, 3))
        return Belief(
            *(np.eye(3), velocity, position, gyro_bias, accelerometer_bias),
            *(np.zeros((feet, 3)), turns, np.zeros((size, size))),
        )


@compiled
def skew(a: Array) -> Array:
    """The matrix (3, 3) of the vector product a × ."""
    return np.array(((0.0, -a[2], a[1]), (a[2], 0.0, -a[0]), (-a[1], a[0], 0.0)))


@compiled
def left_jacobian(turn: Array) -> Array:
    """J_l (3, 3) with Exp(φ + δ) = Exp(J_l(φ) δ) Exp(φ) for small δ."""
    square = turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2
    angle = np.sqrt(square)
    a = 0.5 - square / 24.0 if angle < 1e-3 else (1.0 - np.cos(angle)) / square
    b = 1.0 / 6.0 - square / 120.0 if angle < 1e-3 else (angle - np.sin(angle)) / (square * angle)
    K = skew(turn)
    return np.eye(3) + a * K + b * (K @ K)


@compiled
def retract(belief: Belief, error: Array) -> None:
    """Move a belief by an error: X ← Exp(ξ) X."""
    turn = rotation_of_vector(error[:3])
    J = left_jacobian(error[:3])
    belief.rotation[:] = turn @ belief.rotation
    belief.velocity[:] = turn @ belief.velocity + J @ error[3:6]
    belief.position[:] = turn @ belief.position + J @ error[6:9]
    belief.gyro_bias[:] += error[9:12]
    belief.accelerometer_bias[:] += error[12:15]
    for k in range(len(belief.foot_position)):
        at = FEET + FOOT * k
        belief.foot_position[k] = turn @ belief.foot_position[k] + J @ error[at : at + 3]
        belief.foot_rotation[k] = rotation_of_vector(error[at + 3 : at + 6]) @ belief.foot_rotation[k]


@compiled
def predict(belief: Belief, gyro: Array, accelerometer: Array, gravity: float, period: float) -> Array:
    """Move a belief by one reading of gyro and accelerometer; returns the transition matrix of the error.

    Args:
        belief: Its covariance is left to `spread`.
        gyro, accelerometer: Readings (3,) that hold for the period [rad/s, m/s²].
        gravity: Free fall, along -z [m/s²].
        period: [s].
    """
    half, square = 0.5 * period, 0.5 * period**2
    turn = (gyro - belief.gyro_bias) * period
    R = belief.rotation.copy()
    middle = R @ rotation_of_vector(0.5 * turn)
    force = middle @ (accelerometer - belief.accelerometer_bias)
    acceleration = force.copy()
    acceleration[2] -= gravity
    belief.rotation[:] = R @ rotation_of_vector(turn)
    belief.position[:] += period * belief.velocity + square * acceleration
    belief.velocity[:] += period * acceleration

    F = np.eye(len(belief.covariance))
    bend = R @ left_jacobian(turn) * period  # a bias turns the end of the period by minus this,
    lean = skew(force) @ (R @ left_jacobian(0.5 * turn)) * half  # and the force in its middle
    F[0:3, 9:12] = -bend
    F[3:6, 9:12] = period * lean - skew(belief.velocity) @ bend
    F[6:9, 9:12] = square * lean - skew(belief.position) @ bend
    F[3:6, 12:15], F[6:9, 12:15] = -period * middle, -square * middle
    F[3, 1], F[4, 0] = period * gravity, -period * gravity
    F[6, 1], F[7, 0] = square * gravity, -square * gravity
    for i in range(3):
        F[6 + i, 3 + i] = period
    for k in range(len(belief.foot_position)):
        at = FEET + FOOT * k
        F[at : at + 3, 9:12] = -skew(belief.foot_position[k]) @ bend
    return F


@compiled
def spread(belief: Belief, F: Array, inertial_variance: Array, added_variance: Array) -> None:
    """Carry the covariance over one period.

    Args:
        belief: After `predict`.
        F: What that returned.
        inertial_variance: Of the noise of gyro and accelerometer in this reading, (6,).
        added_variance: Of what walks at random, over the period: biases and feet (15 + 6 feet,).
    """
    P = F @ belief.covariance @ F.T
    noise = F[:, 9:15].copy()  # noise of a reading acts as a bias that lasts for it
    for i in range(6):
        noise[9 + i, i] = 0.0
    P += (noise * inertial_variance) @ noise.T
    for i in range(len(P)):
        P[i, i] += added_variance[i]
    belief.covariance[:] = 0.5 * (P + P.T)


@compiled
def foot_innovation(belief: Belief, k: int, position: Array, rotation: Array) -> Array:
    """How far foot k is from where the belief has it (6,), world axes, from its place in the unit's frame."""
    R, out = belief.rotation, np.empty(6)
    out[:3] = R @ position - (belief.foot_position[k] - belief.position)
    out[3:] = rotation_vector(R @ rotation @ belief.foot_rotation[k].T.copy())
    return out


@compiled
def foot_rows(belief: Belief, k: int) -> Array:
    """Derivative of `foot_innovation` by the error (6, 15 + 6 feet)."""
    H, at = np.zeros((6, len(belief.covariance))), FEET + FOOT * k
    for i in range(3):
        H[i, POSITION + i], H[i, at + i] = -1.0, 1.0
        H[3 + i, ROTATION + i], H[3 + i, at + 3 + i] = -1.0, 1.0
    return H


@compiled
def place_innovation(belief: Belief, k: int, position: Array, rotation: Array) -> Array:
    """How far foot k is believed to be from a place (6,), in that place's axes: position, rotation."""
    out = np.empty(6)
    axes = rotation.T.copy()
    out[:3] = axes @ (position - belief.foot_position[k])
    out[3:] = axes @ rotation_vector(rotation @ belief.foot_rotation[k].T.copy())
    return out


@compiled
def place_rows(belief: Belief, k: int, rotation: Array) -> Array:
    """Derivative of `place_innovation` by the error, where the belief is close (6, 15 + 6 feet)."""
    H, at = np.zeros((6, len(belief.covariance))), FEET + FOOT * k
    axes = rotation.T.copy()
    H[:3, :3] = -axes @ skew(belief.foot_position[k])
    H[:3, at : at + 3] = axes
    H[3:, at + 3 : at + 6] = axes
    return H


@compiled
def squared_distance(belief: Belief, H: Array, innovation: Array, variance: Array) -> float:
    """Mahalanobis distance squared of an innovation (m,) with rows H and measurement variances (m,)."""
    S = H @ belief.covariance @ H.T
    for i in range(len(S)):
        S[i, i] += variance[i]
    return float(innovation @ np.linalg.solve(S, innovation))


@compiled
def correct(belief: Belief, H: Array, innovation: Array, variance: Array) -> None:
    """Correct a belief by an innovation (m,) with rows H (m, n) and measurement variances (m,)."""
    P = belief.covariance
    cross_covariance = P @ H.T
    S = H @ cross_covariance
    for i in range(len(S)):
        S[i, i] += variance[i]
    gain = np.linalg.solve(S, cross_covariance.T.copy()).T.copy()
    corrected = P - gain @ cross_covariance.T
    P[:] = 0.5 * (corrected + corrected.T)
    retract(belief, gain @ innovation)


@compiled
def forget_foot(belief: Belief, k: int) -> None:
    """Take foot k out of the belief: it has no covariance with anything."""
    at = FEET + FOOT * k
    belief.covariance[at : at + FOOT] = 0.0
    belief.covariance[:, at : at + FOOT] = 0.0


@compiled
def place_foot(belief: Belief, k: int, position: Array, rotation: Array, variance: Array) -> None:
    """Put foot k where it is seen from the body, as uncertain as the body and the sight of it together.

    Args:
        belief: Without the foot.
        k: The foot's number.
        position, rotation: Of the sole in the unit's frame.
        variance: Of that, (6,).
    """
    at, P = FEET + FOOT * k, belief.covariance
    belief.foot_position[k] = belief.position + belief.rotation @ position
    belief.foot_rotation[k] = belief.rotation @ rotation
    forget_foot(belief, k)
    for i in range(3):
        P[at + i], P[at + 3 + i] = P[POSITION + i], P[ROTATION + i]
    for i in range(3):
        P[:, at + i], P[:, at + 3 + i] = P[:, POSITION + i], P[:, ROTATION + i]
    for i in range(6):
        P[at + i, at + i] += variance[i]


@compiled
def turn_between(a: Array, b: Array) -> Array:
    """Rotation vector (3,) of the least turn that takes one unit vector to another, for less than half a turn."""
    axis = cross(a, b)
    sine = np.sqrt(axis @ axis)
    angle = np.arctan2(sine, a @ b)
    return axis * (angle / sine) if sine > 1e-9 else axis
