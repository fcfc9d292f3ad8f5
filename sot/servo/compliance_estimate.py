"""How compliant feet are, from what sensors say while the robot moves."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.gravity import GRAVITY
from sot.hardware.readings import Readings
from sot.robots.robot import Robot
from sot.rotation import cross

Array = np.ndarray

LEAST_LOAD_SHARE = 0.2
"""Share of the weight from which on a foot counts as flat on the floor."""
DOUBTED_MOMENT = 0.02
"""Spread of the moments, in m g l, at which an estimate of the compliance is half of what it tends to."""


class ComplianceEstimate:
    """Compliance of feet in roll and pitch, from what IMU, encoders and force sensors say while the robot moves.

    A sole that carries something lies flat; how the foot above it is tilted then follows the moment about the bush. The
    slope of one over the other, by least squares with a constant of each foot's own, is the compliance. It starts at
    none, which is the safe side: sag is undone, and feet yield, as far as is known that they must.

    Args:
        robot: whose feet; both count as alike.
        length: height l of the centre of mass above the feet [m].
        bushes: foot -> middle of the bush (3,) in the foot frame [m].
        imu_point: operational point that the IMU is at.
    """

    def __init__(self, robot: Robot, length: float, bushes: Mapping[str, Array], imu_point: str = "waist") -> None:
        self._robot, self._bushes, self._imu = robot, bushes, robot.point(imu_point)
        self._data, self._q = robot.model.createData(), robot.rest.copy()
        self._least_load = LEAST_LOAD_SHARE * robot.mass * GRAVITY
        self._doubt = (DOUBTED_MOMENT * robot.mass * GRAVITY * length) ** 2
        # Number, sums of moment and tilt, of their squares and product: of each foot and axis.
        self._sums = {foot: np.zeros((5, 2)) for foot in robot.feet}

    def __call__(self, readings: Readings) -> Array:
        """Compliance of roll, pitch [rad/(N m)], and height, which counts as rigid, (3,), after another tick."""
        model, data, q = self._robot.model, self._data, self._q
        q[7:] = readings.joint_position
        pin.framesForwardKinematics(model, data, q)
        imu = data.oMf[self._imu].rotation
        up = imu @ pin.Quaternion(readings.orientation).toRotationMatrix().T @ np.array([0.0, 0.0, 1.0])
        for foot, wrench in readings.foot_wrench.items():
            if wrench[2] > self._least_load:
                x, y, _ = data.oMf[self._robot.point(foot)].rotation.T @ up
                tilt, moment = np.array([y, -x]), (wrench[3:] - cross(self._bushes[foot], wrench[:3]))[:2]
                self._sums[foot] += np.array([np.ones(2), moment, tilt, moment**2, moment * tilt])
        spread, product, count = np.zeros(2), np.zeros(2), 0.0
        for n, moment, tilt, squares, products in self._sums.values():
            if n[0]:
                spread, product = spread + squares - moment**2 / n, product + products - moment * tilt / n
                count += n[0]
        slope = -product / (spread + max(count, 1.0) * self._doubt)
        return np.append(np.maximum(slope, 0.0), 0.0)
