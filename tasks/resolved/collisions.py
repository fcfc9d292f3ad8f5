"""Weights that slow down joints which bring shapes together, Hammam (22)-(27)."""

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class CollisionFunction:
    """``g(d) = ρ e^(−α d) d^(−β)`` of a distance, Hammam (25).

    Args:
        amplitude: ρ.
        decay: α [1/m].
        exponent: β.
    """

    amplitude: float = 1.0
    decay: float = 50.0
    exponent: float = 2.0

    def __call__(self, d: Array) -> Array:
        """g, shape (n,). Below a distance of 0 it falls again."""
        value: Array = self.amplitude * np.exp(-self.decay * d) * d**-self.exponent
        return value

    def slope(self, d: Array) -> Array:
        """∂g/∂d, Hammam (26), shape (n,)."""
        slope: Array = -self(d) * (self.exponent / d + self.decay)
        return slope

    def curvature(self, d: Array) -> Array:
        """Second derivative, shape (n,)."""
        curvature: Array = self(d) * ((self.exponent / d + self.decay) ** 2 + self.exponent / d**2)
        return curvature


def collision_gradient(function: CollisionFunction, distances: Array, jacobian: Array) -> Array:
    """∇f of each pair, Hammam (22): shape (pairs, nv), from distances (pairs,) and their Jacobian, Hammam (23)."""
    gradient: Array = function.slope(distances)[:, None] * jacobian
    return gradient


def printed_collision_weights(function: CollisionFunction, distances: Array, jacobian: Array, v: Array) -> Array:
    """w_COL, Hammam (24), (27): |∇f| of each joint where it does not fall, mean over the pairs; shape (nv,)."""
    if not len(distances):
        return np.zeros(len(v))
    # The rate of |∇f| as of a distance's slope: the normal is taken as fixed.
    rates = np.sign(function.slope(distances)) * function.curvature(distances) * (jacobian @ v)
    gradient = np.abs(collision_gradient(function, distances, jacobian))
    mean: Array = (gradient * (rates >= 0.0)[:, None]).mean(axis=0)
    return mean
