"""Position and orientation of a point of the robot or of a thing, any axes of them, Ramos (18)-(19)."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.control.pose import AXES, AXIS_NAMES, PoseReference
from sot.control.task import MotionTask
from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.rotation import rotation_vector
from tasks.targets import fixed_pose

Array = np.ndarray


class OperationalPoint(MotionTask):
    """A point of the robot, or of a thing, follows a trajectory or goes to a target, in the axes selected.

    Args:
        robot: The robot, or the system of it and the things.
        point: Name of one of its operational points; a thing's name is one.
        reference: A trajectory ``t -> Pose``, a target placement (`pin.SE3`), or, without RPY, a target position (3,).
        axes: Any of "xyz" (position) and "RPY" (rotation about the world's X, Y, Z), the selection of Ramos (18).
        kp, kd, weight: As for `MotionTask`.
        name: Unless given, the point and its axes.
        joints: A joint group or names of joints that alone are to move the point, all and the base unless given. Of
            the others, the accelerations commanded a tick ago (`Tick.acceleration`) are taken as given.

    Raises:
        InputError: If the robot has no such point or joint, the axes are others, or a position is to give an
            orientation.
    """

    def __init__(
        self,
        robot: Robot | System,
        point: str,
        reference: PoseReference | Array | pin.SE3,
        axes: str = AXES,
        kp: float = 100.0,
        kd: float | None = None,
        weight: float = 1.0,
        name: str | None = None,
        joints: str | Sequence[str] | None = None,
    ) -> None:
        if not axes or set(axes) - set(AXES) or len(set(axes)) < len(axes):
            raise InputError(f"axes '{axes}' of {point}: choose some of {AXES}, each once")
        turns, shifts = set(axes) & set("RPY"), set(axes) & set("xyz")
        unit, error_unit = ("m/s²", "m") if not turns else ("rad/s²", "rad") if not shifts else ("SI", "m, rad")
        super().__init__(name or f"{point} {axes}", unit, error_unit, kp, kd, weight)
        robot.point(point)
        self.point = point
        self.labels = [name for axis, name in zip(AXES, AXIS_NAMES, strict=True) if axis in axes]
        self.selected = np.array([AXES.index(axis) for axis in AXES if axis in axes])
        self._axes: slice | Array = self.selected
        if np.array_equal(self.selected, np.arange(self.selected[0], self.selected[-1] + 1)):
            self._axes = slice(int(self.selected[0]), int(self.selected[-1]) + 1)
        self.reference = reference
        self._other_velocities: Array | None = None
        if joints is not None:
            self._other_velocities = np.setdiff1d(np.arange(robot.nv), 6 + robot.joint_numbers(joints))

    @property
    def reference(self) -> PoseReference:
        """Trajectory that the point follows; anything that the constructor takes may replace it, and acts at once.

        Raises:
            InputError: If a position is to give an orientation.
        """
        return self._reference

    @reference.setter
    def reference(self, reference: PoseReference | Array | pin.SE3) -> None:
        self._reference = self._trajectory(reference)

    def _trajectory(self, reference: PoseReference | Array | pin.SE3) -> PoseReference:
        if callable(reference):
            return reference
        if self.selected[-1] >= 3 and not isinstance(reference, pin.SE3):
            raise InputError(f"{self.name}: a target position has no orientation; give a placement, or xyz")
        return fixed_pose(reference, self.name)

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """Error, its rate, J, J̇ v and feed-forward in the selected axes; orientation errors as rotation vectors."""
        of, frame, target = self._axes, tick.frame(self.point), self._reference(tick.t)
        error, rate = _pose_error(
            frame.position, frame.rotation, frame.velocity, target.position, target.rotation, target.velocity
        )
        J, drift = frame.jacobian[of], frame.drift[of]
        if self._other_velocities is not None:
            J = J.copy()
            drift = drift + J[:, self._other_velocities] @ tick.acceleration[self._other_velocities]
            J[:, self._other_velocities] = 0.0
        return error[of], rate[of], J, drift, target.acceleration[of]


@compiled
def _pose_error(
    position: Array, rotation: Array, velocity: Array, position_to: Array, rotation_to: Array, velocity_to: Array
) -> tuple[Array, Array]:
    """Error of a frame from its target, translation over rotation vector, and its rate, (6,) each, world axes."""
    turn = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            turn[i, j] = (
                rotation_to[i, 0] * rotation[j, 0]
                + rotation_to[i, 1] * rotation[j, 1]
                + rotation_to[i, 2] * rotation[j, 2]
            )
    error = np.empty(6)
    error[:3], error[3:] = position_to - position, rotation_vector(turn)
    return error, velocity_to - velocity
