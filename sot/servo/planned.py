"""The plan as it is, handed to the servos: an open loop."""

import numpy as np

from sot.hardware.readings import Readings
from sot.hardware.servo import JointTargets
from sot.motion.trajectory import Motion

Array = np.ndarray


class PlannedTargets:
    """A position controller that commands the planned joint angles and rates, whatever happens.

    Args:
        motion: the plan.
        period: control period [s].
    """

    def __init__(self, motion: Motion, period: float) -> None:
        self.period, self._motion = period, motion

    def __call__(self, t: float, q: Array, v: Array, readings: Readings) -> JointTargets:
        """The plan at a time [s]; state and readings count for nothing."""
        position, velocity, _ = self._motion.joints(t)
        return JointTargets(position, velocity)
