"""The centre of mass on a trajectory or at a point."""

import numpy as np

from sot.control.task import MotionTask
from sot.control.tick import Tick
from sot.errors import InputError
from tasks.targets import VectorReference, fixed_vector

Array = np.ndarray


class CenterOfMass(MotionTask):
    """The centre of mass follows a trajectory or goes to a target, in any of the axes "xyz".

    Args:
        reference: ``t -> (position, velocity, acceleration)``, shapes (3,), world; or a target (3,).
        axes: Which of "xyz".
        kp, kd, weight: As for `MotionTask`.

    Raises:
        InputError: If the axes are others.
    """

    def __init__(
        self,
        reference: VectorReference | Array,
        axes: str = "xyz",
        kp: float = 100.0,
        kd: float | None = None,
        weight: float = 1.0,
        name: str = "CenterOfMass",
    ) -> None:
        if not axes or set(axes) - set("xyz") or len(set(axes)) < len(axes):
            raise InputError(f"axes '{axes}' of {name}: choose some of xyz, each once")
        super().__init__(name, "m/s²", "m", kp, kd, weight)
        self.labels = "xyz"
        self.selected = np.array(["xyz".index(axis) for axis in "xyz" if axis in axes])
        self.reference = reference

    @property
    def reference(self) -> VectorReference:
        """Trajectory that the centre of mass follows; anything that the constructor takes may replace it, and acts at
        once."""
        return self._reference

    @reference.setter
    def reference(self, reference: VectorReference | Array) -> None:
        self._reference = reference if callable(reference) else fixed_vector(reference, 3, self.name)

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """Error, its rate, J, J̇ v and feed-forward of the centre of mass."""
        position, velocity, acceleration = self._reference(tick.t)
        of = self.selected
        error, rate = (position - tick.com)[of], (velocity - tick.com_velocity)[of]
        return error, rate, tick.com_jacobian[of], tick.com_drift[of], acceleration[of]
