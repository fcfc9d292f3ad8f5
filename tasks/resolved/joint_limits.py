"""Weights that slow a joint down before the end of its range, Hammam (20), (21), Dariush (13), (14)."""

import numpy as np

Array = np.ndarray


def limit_potential(q: Array, lower: Array, upper: Array) -> Array:
    """``(q_max − q_min)² / (4 (q_max − q) (q − q_min))`` of each joint: 1 in the middle of its range, without bound at
    its ends; shape (n,)."""
    potential: Array = (upper - lower) ** 2 / (4.0 * (upper - q) * (q - lower))
    return potential


def limit_gradient(q: Array, lower: Array, upper: Array) -> Array:
    """∇h, Hammam (20): derivative of `limit_potential`, shape (n,) [1/rad]."""
    gradient: Array = (upper - lower) ** 2 * (2.0 * q - upper - lower) / (4.0 * (upper - q) ** 2 * (q - lower) ** 2)
    return gradient


def limit_curvature(q: Array, lower: Array, upper: Array) -> Array:
    """Second derivative of `limit_potential`, shape (n,) [1/rad²]. It is negative outside the range, near its ends."""
    product = (upper - q) * (q - lower)
    curvature: Array = 0.5 * (upper - lower) ** 2 * ((lower + upper - 2.0 * q) ** 2 / product**3 + 1.0 / product**2)
    return curvature


def printed_limit_weights(q: Array, v: Array, lower: Array, upper: Array) -> Array:
    """w_JL, Hammam (21): |∇h| where it does not fall, 0 where it does; shape (n,).

    Outside the range |∇h| falls on the way out: there the printed weight is 0 outwards, and stiff on the way back.
    """
    gradient = limit_gradient(q, lower, upper)
    rate = np.sign(gradient) * limit_curvature(q, lower, upper) * v
    return np.where(rate >= 0.0, np.abs(gradient), 0.0)


def dariush_limit_weights(q: Array, v: Array, lower: Array, upper: Array) -> Array:
    """w_JL, Dariush (14): ``1 + |∂H/∂q|`` where that does not fall, 1 where it does; shape (n,)."""
    weights: Array = 1.0 + printed_limit_weights(q, v, lower, upper)
    return weights
