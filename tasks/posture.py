"""Joint positions that follow a reference, Ramos (16)-(17)."""

from collections.abc import Sequence

import numpy as np

from sot.control.task import MotionTask
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.targets import VectorReference, fixed_vector

Array = np.ndarray


class Posture(MotionTask):
    """Any subset of the joints follows a reference; the Jacobian selects them, Ramos (16).

    Args:
        robot: The robot.
        reference: ``t -> (position, velocity, acceleration)`` of all joints, shapes (na,); or a constant posture (na,).
        joints: A joint group of the robot, or joint names; all joints unless given.
        kp, kd: Gains of `MotionTask`.
        feedforward: Whether the reference's acceleration is added; without it the task is Ramos (17).
        weight: Scale within the level.
        name: Unless given, "Posture" and the joint group.

    Raises:
        InputError: If the robot has no such group or joint.
    """

    def __init__(
        self,
        robot: Robot,
        reference: VectorReference | Array,
        joints: str | Sequence[str] | None = None,
        kp: float = 100.0,
        kd: float | None = None,
        feedforward: bool = True,
        weight: float = 1.0,
        name: str | None = None,
    ) -> None:
        label = "Posture" if joints is None else f"Posture {joints if isinstance(joints, str) else ' '.join(joints)}"
        super().__init__(name or label, "rad/s²", "rad", kp, kd, weight)
        self.joints = np.arange(robot.na) if joints is None else robot.joint_numbers(joints)
        self.labels = [robot.joints[joint] for joint in self.joints]
        self.feedforward = feedforward
        self._joint_count = robot.na
        self.reference = reference
        self._J = np.zeros((len(self.joints), robot.nv))
        self._J[np.arange(len(self.joints)), 6 + self.joints] = 1.0
        self._no_drift = np.zeros(len(self.joints))
        if len(self.joints) and np.array_equal(self.joints, np.arange(self.joints[0], self.joints[-1] + 1)):
            self._selected: slice | Array = slice(int(self.joints[0]), int(self.joints[-1]) + 1)
            self.selects = slice(6 + self._selected.start, 6 + self._selected.stop)
        else:
            self._selected = self.joints

    @property
    def reference(self) -> VectorReference:
        """Trajectory of all joints; anything that the constructor takes may replace it, and acts at once."""
        return self._reference

    @reference.setter
    def reference(self, reference: VectorReference | Array) -> None:
        self._reference = reference if callable(reference) else fixed_vector(reference, self._joint_count, self.name)

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """Error, its rate, J, J̇ v and feed-forward of the joints."""
        position, velocity, acceleration = self._reference(tick.t)
        of = self._selected
        forward = acceleration[of] if self.feedforward else self._no_drift
        return (
            position[of] - tick.joint_positions[of],
            velocity[of] - tick.joint_velocities[of],
            self._J,
            self._no_drift,
            forward,
        )
