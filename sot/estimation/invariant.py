"""The invariant filter's arithmetic: a rigid body with an inertial unit, and feet that stand (Hartley 2020).

The error of a belief X̂ is right-invariant, in world axes: X = Exp(ξ) X̂ for the body's rotation, velocity and position
and the feet's positions together, C = Exp(ξ_C) Ĉ for each foot's rotation, and a plain difference for the biases. So a
foot that is seen from the body gives rows that do not depend on the belief, and what cannot be observed, place and
heading, stays unobserved.
"""

from typing import NamedTuple

import numpy as np

from solvers.compiled import compiled
from sot.rotation import cross, product, rotated, rotation_of_vector, rotation_vector

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
    return np.eye(3) + a * K + b * product(K, K)


@compiled
def turn_between(a: Array, b: Array) -> Array:
    """Rotation vector (3,) of the least turn that takes one unit vector to another, for less than half a turn."""
    axis = cross(a, b)
    sine = np.sqrt(axis @ axis)
    angle = np.arctan2(sine, a @ b)
    return axis * (angle / sine) if sine > 1e-9 else axis


@compiled
def retract(belief: Belief, error: Array) -> None:
    """Move a belief by an error: X ← Exp(ξ) X."""
    turn = rotation_of_vector(error[:3])
    J = left_jacobian(error[:3])
    belief.rotation[:] = product(turn, belief.rotation)
    belief.velocity[:] = rotated(turn, belief.velocity) + rotated(J, error[3:6])
    belief.position[:] = rotated(turn, belief.position) + rotated(J, error[6:9])
    belief.gyro_bias[:] += error[9:12]
    belief.accelerometer_bias[:] += error[12:15]
    for k in range(len(belief.foot_position)):
        at = FEET + FOOT * k
        belief.foot_position[k] = rotated(turn, belief.foot_position[k]) + rotated(J, error[at : at + 3])
        belief.foot_rotation[k] = product(rotation_of_vector(error[at + 3 : at + 6]), belief.foot_rotation[k])


@compiled
def predict(belief: Belief, gyro: Array, accelerometer: Array, gravity: float, period: float) -> Array:
    """Move a belief by one reading of gyro and accelerometer.

    Args:
        belief: Its covariance is left to `spread`.
        gyro, accelerometer: Readings (3,) that hold for the period [rad/s, m/s²].
        gravity: Free fall, along -z [m/s²].
        period: [s].

    Returns:
        Derivative of the error by the body's part of what it was, (15 + 6 feet, 15); the feet's part stays as well.
    """
    half, square = 0.5 * period, 0.5 * period**2
    turn = (gyro - belief.gyro_bias) * period
    R = belief.rotation.copy()
    middle = product(R, rotation_of_vector(0.5 * turn))
    force = rotated(middle, accelerometer - belief.accelerometer_bias)
    acceleration = force.copy()
    acceleration[2] -= gravity
    belief.rotation[:] = product(R, rotation_of_vector(turn))
    belief.position[:] += period * belief.velocity + square * acceleration
    belief.velocity[:] += period * acceleration

    F = np.eye(len(belief.covariance), FEET)
    bend = product(R, left_jacobian(turn)) * period  # a bias turns the end of the period by minus this,
    lean = product(skew(force), product(R, left_jacobian(0.5 * turn))) * half  # and the force in its middle
    F[0:3, 9:12] = -bend
    F[3:6, 9:12] = period * lean - product(skew(belief.velocity), bend)
    F[6:9, 9:12] = square * lean - product(skew(belief.position), bend)
    F[3:6, 12:15], F[6:9, 12:15] = -period * middle, -square * middle
    F[3, 1], F[4, 0] = period * gravity, -period * gravity
    F[6, 1], F[7, 0] = square * gravity, -square * gravity
    for i in range(3):
        F[6 + i, 3 + i] = period
    for k in range(len(belief.foot_position)):
        at = FEET + FOOT * k
        F[at : at + 3, 9:12] = -product(skew(belief.foot_position[k]), bend)
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
    P = belief.covariance
    P[:] = _moved(F, _moved(F, P).T.copy())
    noise = F[:, GYRO_BIAS:].copy()  # noise of a reading acts as a bias that lasts for it
    for i in range(6):
        noise[GYRO_BIAS + i, i] = 0.0
        noise[:, i] *= np.sqrt(inertial_variance[i])
    for i in range(len(P)):
        for m in range(6):
            if noise[i, m] != 0.0:
                for j in range(len(P)):
                    P[i, j] += noise[i, m] * noise[j, m]
        P[i, i] += added_variance[i]


@compiled
def _moved(F: Array, P: Array) -> Array:
    """Product of a transition, whose columns of the feet are left out, with a matrix; most of a transition is zero."""
    ahead = np.zeros(P.shape)
    for i in range(len(P)):
        if i >= FEET:
            ahead[i] = P[i]
        for m in range(FEET):
            if F[i, m] != 0.0:
                for j in range(P.shape[1]):
                    ahead[i, j] += F[i, m] * P[m, j]
    return ahead


@compiled
def advance(
    belief: Belief,
    gyro: Array,
    accelerometer: Array,
    gravity: float,
    period: float,
    inertial_variance: Array,
    added_variance: Array,
) -> None:
    """`predict`, then `spread`."""
    F = predict(belief, gyro, accelerometer, gravity, period)
    spread(belief, F, inertial_variance, added_variance)


@compiled
def foot_innovation(belief: Belief, k: int, position: Array, rotation: Array) -> Array:
    """How far foot k is from where the belief has it (6,), world axes, from its place in the unit's frame."""
    R, out = belief.rotation, np.empty(6)
    out[:3] = rotated(R, position) - (belief.foot_position[k] - belief.position)
    out[3:] = rotation_vector(product(product(R, rotation), belief.foot_rotation[k].T))
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
    axes = rotation.T
    out[:3] = rotated(axes, position - belief.foot_position[k])
    out[3:] = rotated(axes, rotation_vector(product(rotation, belief.foot_rotation[k].T)))
    return out


@compiled
def place_rows(belief: Belief, k: int, rotation: Array) -> Array:
    """Derivative of `place_innovation` by the error, where the belief is close (6, 15 + 6 feet)."""
    H, at = np.zeros((6, len(belief.covariance))), FEET + FOOT * k
    axes = rotation.T
    H[:3, :3] = -product(axes, skew(belief.foot_position[k]))
    H[:3, at : at + 3] = axes
    H[3:, at + 3 : at + 6] = axes
    return H


@compiled
def correct(belief: Belief, H: Array, innovation: Array, variance: Array, gate: float, loose: int) -> bool:
    """Correct a belief by an innovation.

    Args:
        belief: Is changed.
        H: Derivative of the innovation by the error (m, 15 + 6 feet).
        innovation: (m,).
        variance: Of its measurement (m,).
        gate: Squared Mahalanobis distance of the innovation from which on it is not believed to be an error; infinite
            for none. What has moved then, `loose` and the next m coordinates, becomes as uncertain as it is large.
        loose: See there.

    Returns:
        Whether it was beyond the gate.
    """
    P, count = belief.covariance, len(innovation)
    towards = np.zeros((count, len(P)))
    for i in range(count):
        for m in range(len(P)):
            if H[i, m] != 0.0:
                for j in range(len(P)):
                    towards[i, j] += H[i, m] * P[m, j]
    half = np.column_stack((innovation, towards))
    _whiten(_innovation_covariance(H, towards, variance), half)
    white = half[:, 0].copy()
    beyond = white @ white > gate
    if beyond:
        for i in range(count):
            at = loose + i
            P[at, at] += innovation[i] ** 2
            towards[:, at] += H[:, at] * innovation[i] ** 2
        half = np.column_stack((innovation, towards))
        _whiten(_innovation_covariance(H, towards, variance), half)
    error = np.zeros(len(P))
    for i in range(count):
        for m in range(len(P)):
            error[m] += half[i, 0] * half[i, 1 + m]
            for j in range(len(P)):
                P[m, j] -= half[i, 1 + m] * half[i, 1 + j]
    retract(belief, error)
    return bool(beyond)


@compiled
def _innovation_covariance(H: Array, towards: Array, variance: Array) -> Array:
    """H P Hᵀ and the measurement's variance (m, m), from the rows and their product with P."""
    S = np.diag(variance)
    for i in range(len(H)):
        for m in range(H.shape[1]):
            if H[i, m] != 0.0:
                for j in range(len(H)):
                    S[j, i] += towards[j, m] * H[i, m]
    return S


@compiled
def _whiten(S: Array, X: Array) -> None:
    """Multiply X (m, n) by L⁻¹, S = L Lᵀ (m, m); L takes the place of the lower triangle of S."""
    for i in range(len(S)):
        for j in range(i + 1):
            for k in range(j):
                S[i, j] -= S[i, k] * S[j, k]
            S[i, j] = np.sqrt(S[i, i]) if i == j else S[i, j] / S[j, j]
        for j in range(i):
            for k in range(X.shape[1]):
                X[i, k] -= S[i, j] * X[j, k]
        for k in range(X.shape[1]):
            X[i, k] /= S[i, i]


@compiled
def see_foot(belief: Belief, k: int, position: Array, rotation: Array, variance: Array, gate: float) -> bool:
    """Correct by where foot k is in the unit's frame, see `correct`; whether it has slipped."""
    innovation = foot_innovation(belief, k, position, rotation)
    return correct(belief, foot_rows(belief, k), innovation, variance, gate, FEET + FOOT * k)


@compiled
def lay_flat(belief: Belief, k: int, normal: Array, height: float, variance: Array) -> None:
    """Correct by a floor under foot k: its height along the normal, and roll and pitch; their variances are (3,)."""
    turn = rotation_of_vector(turn_between(belief.foot_rotation[k, :, 2].copy(), normal))
    axes = product(turn, belief.foot_rotation[k])
    place = belief.foot_position[k] - normal * (normal @ belief.foot_position[k] - height)
    innovation, rows = place_innovation(belief, k, place, axes), place_rows(belief, k, axes)
    correct(belief, rows[2:5].copy(), innovation[2:5].copy(), variance, np.inf, 0)


@compiled
def put_on_foothold(belief: Belief, k: int, position: Array, rotation: Array, variance: Array) -> None:
    """Correct by a foothold of foot k: place along its x and y, and heading; their variances are (3,)."""
    innovation, rows = place_innovation(belief, k, position, rotation), place_rows(belief, k, rotation)
    some, of_rows = np.empty(3), np.empty((3, rows.shape[1]))
    for i, axis in enumerate((0, 1, 5)):
        some[i], of_rows[i] = innovation[axis], rows[axis]
    correct(belief, of_rows, some, variance, np.inf, 0)


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
    belief.foot_position[k] = belief.position + rotated(belief.rotation, position)
    belief.foot_rotation[k] = product(belief.rotation, rotation)
    forget_foot(belief, k)
    for i in range(3):
        P[at + i], P[at + 3 + i] = P[POSITION + i], P[ROTATION + i]
    for i in range(3):
        P[:, at + i], P[:, at + 3 + i] = P[:, POSITION + i], P[:, ROTATION + i]
    for i in range(6):
        P[at + i, at + i] += variance[i]


@compiled
def base_state(
    belief: Belief,
    gyro: Array,
    gyro_now: Array,
    accelerometer: Array,
    gravity: float,
    age: float,
    unit_in_base: tuple[Array, Array],
) -> tuple[Array, Array, Array]:
    """Rotation (3, 3), position (3,) and velocity (6,), in its own axes, of a base that the unit is fixed to.

    Args:
        belief: Of the unit.
        gyro, accelerometer: Readings (3,) at the belief's time.
        gyro_now: What the gyro would say now (3,).
        gravity: [m/s²].
        age: For how long the belief is carried on [s].
        unit_in_base: Rotation (3, 3) and position (3,).
    """
    turning = gyro_now - belief.gyro_bias
    mean = 0.5 * (gyro + gyro_now) - belief.gyro_bias
    acceleration = rotated(belief.rotation, accelerometer - belief.accelerometer_bias)
    acceleration[2] -= gravity
    turn, at = unit_in_base
    rotation = product(product(belief.rotation, rotation_of_vector(age * mean)), turn.T)
    velocity = np.empty(6)
    velocity[3:] = rotated(turn, turning)
    velocity[:3] = rotated(rotation.T, belief.velocity + age * acceleration) - cross(velocity[3:], at)
    return rotation, belief.position + age * belief.velocity - rotated(rotation, at), velocity
