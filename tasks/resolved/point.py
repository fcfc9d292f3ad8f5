"""A point of the robot as resolved acceleration follows it: feedback of Hammam (11), (12) and (15) in one row."""

import numpy as np

from solvers.rows import Rows
from sot.control.pose import PoseReference
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.operational_point import OperationalPoint
from tasks.resolved.orientation import orientation_error

Array = np.ndarray


class ResolvedPoint(OperationalPoint):
    """Rows ``J y = a* − J̇ q̇ + G_v v*`` with ``a* = a_d + K_v (v_d − v) + K_p e`` and ``v* = v_d + K e``, or ``J q̇ = v*``.

    Args:
        robot, point, reference, axes: As of `OperationalPoint`.
        kp: K_p of (11) [1/s²], K_v critical; the same in all axes.
        velocity_kp: K_p of (15) [1/s].
        velocity_gain: G_v of (31) [1/s]; infinite for rows on velocities alone.
    """

    def __init__(
        self,
        robot: Robot,
        point: str,
        reference: PoseReference,
        axes: str = "xyzRPY",
        kp: float = 300.0,
        velocity_kp: float = 20.0,
        velocity_gain: float = 30.0,
    ) -> None:
        super().__init__(robot, point, reference, axes, kp)
        self.velocity_kp, self.velocity_gain = velocity_kp, velocity_gain

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """As of `OperationalPoint`, orientation errors by Hammam (12)."""
        error, rate, J, drift, forward = super().observe(tick)
        if self.selected[-1] >= 3:
            turn = orientation_error(tick.frame(self.point).rotation, self.reference(tick.t).rotation)
            error = np.where(self.selected < 3, error, np.concatenate([np.zeros(3), turn])[self.selected])
        return error, rate, J, drift, forward

    def rows(self, tick: Tick) -> Rows:
        """Rows on y, or on q̇."""
        self.error, rate, J, drift, forward = self.observe(tick)
        wanted = rate + J @ tick.v + self.velocity_kp * self.error
        if np.isfinite(self.velocity_gain):
            wanted = self.velocity_gain * wanted + forward + self.kd * rate + self.kp * self.error - drift
        return self.make_rows(J, wanted, wanted)


