"""Estimated against simulated base of a run."""

import numpy as np
import pinocchio as pin

from sim.log import RunLog

Array = np.ndarray


def position_errors(log: RunLog) -> Array:
    """Estimated minus simulated position of the base (T, 3), world axes [m]."""
    return log.base_estimate[:, :3] - log.q[:, :3]


def rotation_errors(log: RunLog) -> Array:
    """Rotation vectors (T, 3), world axes, that take the simulated base to the estimated one [rad]."""
    pairs = zip(rotations_of(log.base_estimate), rotations_of(log.q), strict=True)
    return np.array([pin.log3(estimated @ true.T) for estimated, true in pairs])


def velocity_errors(log: RunLog) -> Array:
    """Estimated minus simulated velocity of the base's origin (T, 3), world axes [m/s]."""
    return world_velocity(log.base_estimate, log.base_velocity_estimate) - world_velocity(log.q, log.v)


def world_velocity(q: Array, v: Array) -> Array:
    """Velocity of the base's origin (T, 3), world axes, of states in Pinocchio's conventions [m/s]."""
    return np.einsum("tij,tj->ti", rotations_of(q), v[:, :3])


def rotations_of(q: Array) -> Array:
    return np.array([pin.Quaternion(quaternion).matrix() for quaternion in q[:, 3:7]])
