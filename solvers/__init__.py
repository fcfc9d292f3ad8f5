"""Solvers of hierarchies of linear rows. They know numbers only, no robot."""

from solvers.cascade import Cascade
from solvers.resolved_acceleration import Penalties, ResolvedAcceleration, damped_inverse
from solvers.rows import Block, Level, LevelResult, Rows, Solution, Solver, Status
from solvers.task_correction import TaskCorrection
from solvers.weighted import Weighted

__all__ = [
    "Block",
    "Cascade",
    "Level",
    "LevelResult",
    "Penalties",
    "ResolvedAcceleration",
    "Rows",
    "Solution",
    "Solver",
    "Status",
    "TaskCorrection",
    "Weighted",
    "damped_inverse",
]
