"""A made-up robot motion over feet that stand, slip and swing, and the readings of its sensors, without physics."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from sot.estimation import Footing
from sot.gravity import GRAVITY
from sot.hardware.readings import Readings
from sot.robots.robot import Robot

Array = np.ndarray
PERIOD, STANCE_S = 0.005, 1.0


class SteppingMotion:
    """Joints that swing as sines, on one foot for a second, then on the other, which stays where it was just then.

    Args:
        robot: who moves.
        slip: how far the standing foot has slipped at a time [s], (3,) in the world [m]; not at all unless given.
        place: where the first standing foot is.
    """

    def __init__(
        self, robot: Robot, slip: Callable[[float], Array] = lambda t: np.zeros(3), place: pin.SE3 | None = None
    ) -> None:
        self.robot, self._slip, self._data = robot, slip, robot.model.createData()
        rng = np.random.default_rng(0)
        self._phase, self._swing = rng.uniform(0, 6, robot.na), 0.15 * rng.uniform(0.3, 1, robot.na)
        self._frames = {foot: robot.point(foot) for foot in robot.feet}
        self._imu = robot.point("waist")
        self._stances = [place or pin.SE3.Identity()]
        for k in range(1, 8):
            pose = self._pose(k * STANCE_S - 1e-9)
            self._stances.append(pose * self._in_base(k * STANCE_S, self.foot(k * STANCE_S)))

    def foot(self, t: float) -> str:
        """The foot that stands."""
        return self.robot.feet[int(t / STANCE_S) % 2]

    def sole(self, t: float) -> pin.SE3:
        """Where it stands."""
        pose = self._stances[int(t / STANCE_S)]
        return pin.SE3(pose.rotation, pose.translation + self._slip(t))

    def joints(self, t: float) -> tuple[Array, Array]:
        """Position and velocity of the joints, at rest when the feet change."""
        angle = 2.0 * (t - np.sin(2.0 * np.pi * t / STANCE_S) * STANCE_S / (2.0 * np.pi)) + self._phase
        rate = 2.0 * (1.0 - np.cos(2.0 * np.pi * t / STANCE_S))
        return self.robot.rest[7:] + self._swing * np.sin(angle), rate * self._swing * np.cos(angle)

    def _in_base(self, t: float, foot: str) -> pin.SE3:
        q = pin.neutral(self.robot.model)
        q[7:] = self.joints(t)[0]
        pin.forwardKinematics(self.robot.model, self._data, q)
        return pin.updateFramePlacement(self.robot.model, self._data, self._frames[foot]).copy()

    def _pose(self, t: float) -> pin.SE3:
        return self.sole(t) * self._in_base(t, self.foot(t)).inverse()

    def state(self, t: float, step: float = 1e-5) -> tuple[Array, Array]:
        """Configuration and velocity at a time [s] that is not within the step of a change of feet."""
        q, v = np.empty(self.robot.nq), np.empty(self.robot.nv)
        q[:7], (q[7:], v[6:]) = pin.SE3ToXYZQUAT(self._pose(t)), self.joints(t)
        v[:6] = pin.log6(self._pose(t - step).actInv(self._pose(t + step))).vector / (2.0 * step)
        return q, v

    def readings(self, t: float, loads: dict[str, float], step: float = 1e-4) -> Readings:
        """Perfect readings; the loads are shares of the weight, and the base is where the inertial unit is."""
        robot = self.robot
        poses = [self._pose(t + k * step) for k in (-1, 0, 1)]
        before, now, after = poses
        acceleration = (before.translation - 2.0 * now.translation + after.translation) / step**2
        wrenches = {}
        for foot in robot.feet:
            up = (now * self._in_base(t, foot)).rotation.T[:, 2]
            wrenches[foot] = np.concatenate([loads.get(foot, 0.0) * robot.mass * GRAVITY * up, np.zeros(3)])
        position, velocity = self.joints(t)
        unit = pin.SE3(poses[1]).rotation
        return Readings(
            t,
            position,
            velocity,
            pin.Quaternion(unit).coeffs().copy(),
            pin.log3(before.rotation.T @ after.rotation) / (2.0 * step),
            unit.T @ (acceleration + np.array([0.0, 0.0, GRAVITY])),
            wrenches,
        )

    def footing(self, t: float) -> Footing:
        """The floor that happens to be under the standing foot."""
        return Footing(self.sole(t))
