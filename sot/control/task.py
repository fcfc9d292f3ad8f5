"""Base classes of tasks and limits: what the controller asks of them at each tick."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Rows
from sot.control.tick import Tick
from sot.errors import InvalidRowsError

Array = np.ndarray
Variable = Literal["acceleration", "torque", "force"]


class Task(ABC):
    """An objective or a limit: rows ``lower <= A y <= upper`` in one kind of variable y.

    Attributes:
        variable: What y is: the accelerations v̇ (nv), the joint torques τ (na) or the contact forces φ.
        equality: Whether lower and upper agree in every row, at any tick.
        gives_way: In level 0, its place in the order in which limits are relaxed; 0 for never.
        optional: In level 0, whether it is left out where a level above the last two would pay for it.
        name: Name of the task, in reports.
        unit: Unit of A y.
        error_unit: Unit of `error`.
        weight: Scale of its rows within its level.
        error: Reference minus measured, or a limit's excess, at the last tick, shape (m,).
        labels: Names of its rows, or of the first of them.
        selects: If A is a run of rows of the identity, which ones (see `Rows`).
    """

    variable: ClassVar[Variable] = "acceleration"
    equality: ClassVar[bool] = True
    gives_way: ClassVar[int] = 0
    optional: ClassVar[bool] = False

    def __init__(self, name: str, unit: str, error_unit: str, weight: float = 1.0) -> None:
        if not weight > 0.0:
            raise ValueError(f"{name}: weight must be positive, not {weight}")
        self.name, self.unit, self.error_unit, self.weight = name, unit, error_unit, weight
        self.error: Array = np.zeros(0)
        self.labels: Sequence[str] = ()
        self.selects: slice | None = None
        self._made: Rows | None = None

    @abstractmethod
    def rows(self, tick: Tick) -> Rows:
        """The rows at this tick, valid until the next one, and `error` as a side effect."""

    def make_rows(self, A: Array, lower: Array, upper: Array) -> Rows:
        """The task's rows, always the same object."""
        rows = self._made
        if rows is None:
            rows = self._made = Rows(
                self.name, self.unit, A, lower, upper, gives_way=self.gives_way, optional=self.optional
            )
        rows.A, rows.lower, rows.upper, rows.weight, rows.selects = A, lower, upper, self.weight, self.selects
        return rows


class MotionTask(Task):
    """A task on an observable x(q): ``ẍ* = ẍ_ref + kp e + kd ė``, rows ``J v̇ = ẍ* − J̇ v``, Ramos (15).

    Args:
        kp: Stiffness [1/s²].
        kd: Damping [1/s]; critical, 2 √kp, unless given.
    """

    def __init__(
        self, name: str, unit: str, error_unit: str, kp: float, kd: float | None = None, weight: float = 1.0
    ) -> None:
        super().__init__(name, unit, error_unit, weight)
        if kp < 0.0 or (kd is not None and kd < 0.0):
            raise ValueError(f"{name}: gains must not be negative, not kp = {kp}, kd = {kd}")
        self.kp = kp
        self.kd = 2.0 * float(np.sqrt(kp)) if kd is None else kd

    @abstractmethod
    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """Error e = x_ref − x (m,), its rate ė (m,), J (m, nv), J̇ v (m,), feed-forward ẍ_ref (m,)."""

    def rows(self, tick: Tick) -> Rows:
        """Acceleration rows."""
        self.error, rate, J, drift, feedforward = self.observe(tick)
        try:
            wanted = _pd_acceleration(self.error, rate, drift, feedforward, self.kp, self.kd)
        except Exception as error:
            shapes = [np.shape(part) for part in (self.error, rate, J, drift, feedforward)]
            raise InvalidRowsError(
                f"task '{self.name}': observe(tick) returned float arrays of shapes {', '.join(map(str, shapes))}; "
                "wanted are error (m,), its rate (m,), J (m, nv), J̇ v (m,) and feed-forward (m,)"
            ) from error
        return self.make_rows(J, wanted, wanted)


@compiled
def _pd_acceleration(error: Array, rate: Array, drift: Array, feedforward: Array, kp: float, kd: float) -> Array:
    return feedforward + kp * error + kd * rate - drift
