"""Where a controller's state comes from: the simulation itself, or an estimator that has readings only."""

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Protocol

import numpy as np

from sim.log import RunLog
from sim.world import World
from sot.estimation import Estimator, Footing

Array = np.ndarray
PlannedFootings = Callable[[float], Mapping[str, Footing]]
"""The feet that are planned to stand at a time [s]."""


class StateSource(Protocol):
    """Tells a controller where its robot is."""

    def reset(self, q: Array, v: Array) -> None:
        """Start over with the robot at (q, v)."""
        ...

    def __call__(self, k: int, t: float, q: Array, v: Array, log: RunLog) -> tuple[Array, Array]:
        """The state at tick k and a time [s], while the simulated one is (q, v); what it was made of is logged."""
        ...

    def loads(self) -> Mapping[str, float]:
        """Vertical force of the floor on each foot [N]."""
        ...


class SimulatedState:
    """The simulated state, with the mismatch's noise on angular velocities.

    Args:
        world: the simulation.
    """

    def __init__(self, world: World) -> None:
        self._world = world

    def reset(self, q: Array, v: Array) -> None:
        pass

    def __call__(self, k: int, t: float, q: Array, v: Array, log: RunLog) -> tuple[Array, Array]:
        return self._world.measured(q, v)

    def loads(self) -> Mapping[str, float]:
        return {foot: float(wrench[2]) for foot, wrench in self._world.foot_wrenches().items()}


class EstimatedState:
    """What an estimator makes of the robot's sensors; the simulated state is logged beside it, and not used.

    Args:
        world: whose robot has sensors.
        estimator: of its state.
        footings: what the plan knows of feet that are to stand.
    """

    def __init__(self, world: World, estimator: Estimator, footings: PlannedFootings) -> None:
        self._world, self._estimator, self._footings = world, estimator, footings

    def reset(self, q: Array, v: Array) -> None:
        self._estimator.reset(q, v)

    def __call__(self, k: int, t: float, q: Array, v: Array, log: RunLog) -> tuple[Array, Array]:
        readings, footings = self._world.readings(), self._footings(t)
        begin = perf_counter()
        estimated = self._estimator(t, readings, footings)
        log.estimate_us[k] = 1e6 * (perf_counter() - begin)
        log.base_estimate[k], log.base_velocity_estimate[k] = estimated[0][:7], estimated[1][:6]
        return estimated

    def loads(self) -> Mapping[str, float]:
        return self._estimator.loads
