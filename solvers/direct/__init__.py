"""The short way of a usual tick: one factorisation for all levels."""

from solvers.direct.solver import DirectSolver, least_norm_solution

__all__ = ["DirectSolver", "least_norm_solution"]
