"""Resolved acceleration: prioritised tasks by weighted, damped inverses; weights stand in for limits."""

from solvers.resolved_acceleration.inverse import damped_inverse
from solvers.resolved_acceleration.penalties import Penalties
from solvers.resolved_acceleration.solver import ResolvedAcceleration

__all__ = ["Penalties", "ResolvedAcceleration", "damped_inverse"]
