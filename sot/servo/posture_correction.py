"""Joint targets of a planned posture whose centre of mass and feet are to be a little elsewhere."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.hardware.compliance import bush_position, sole_in_foot
from sot.hardware.servo import JointTargets, Servo
from sot.robots.robot import Robot

Array = np.ndarray

DAMPING = 1e-3
"""Damping of the legs' inverse: a stretched knee has a say."""
STEPS_AT_START = 8
"""Newton steps at the first call, which has no offsets of the last tick to begin with."""


class PostureCorrection:
    """Legs that bring feet and centre of mass where they are to be, all else as planned.

    The offsets vary slowly: one Newton step a tick, from where the last one left the legs, keeps up with them.

    Args:
        robot: whose legs.
        period: between calls [s].
    """

    def __init__(self, robot: Robot, period: float) -> None:
        self._robot, self._period = robot, period
        self._planned, self._moved = robot.model.createData(), robot.model.createData()
        self._frames = {foot: robot.point(foot) for foot in robot.feet}
        self._legs = {foot: _leg(robot, frame) for foot, frame in self._frames.items()}
        self._bushes = {foot: bush_position(robot, foot) for foot in robot.feet}
        self._damping = DAMPING**2 * np.eye(6)
        self._offset, self._shift = np.zeros(robot.na), np.zeros(3)
        self._started = False

    def __call__(self, q: Array, v: Array, com_shift: Array, offsets: Mapping[str, Array]) -> JointTargets:
        """Targets of a planned state.

        Args:
            q, v: planned (nq,), (nv,).
            com_shift: of the centre of mass off its plan (2,) [m].
            offsets: foot -> roll, pitch [rad] and height [m] by which it is to be off its plan (3,): turned about its
                bush and moved along its z axis, as `sole_in_foot` has it.
        """
        for _ in range(1 if self._started else STEPS_AT_START):
            before = self._offset.copy()
            self._step(q, com_shift, offsets)
        rate = (self._offset - before) / self._period if self._started else np.zeros_like(before)
        self._started = True
        return JointTargets(q[7:] + self._offset, v[6:] + rate)

    def _step(self, q: Array, com_shift: Array, offsets: Mapping[str, Array]) -> None:
        """One Newton step of legs and base."""
        model, planned, moved = self._robot.model, self._planned, self._moved
        com = pin.centerOfMass(model, planned, q, False)
        reached = q.copy()
        reached[:3] += self._shift
        reached[7:] += self._offset
        pin.computeJointJacobians(model, moved, reached)
        for foot, frame in self._frames.items():
            wanted, own = (pin.updateFramePlacement(model, data, frame) for data in (planned, moved))
            if foot in offsets:
                wanted = wanted * sole_in_foot(self._bushes[foot], offsets[foot])
            turn = pin.log3(wanted.rotation @ own.rotation.T)
            error = np.concatenate([wanted.translation - own.translation, turn])
            leg = self._legs[foot]
            J = pin.getFrameJacobian(model, moved, frame, pin.LOCAL_WORLD_ALIGNED)[:, leg]
            self._offset[leg - 6] += J.T @ np.linalg.solve(J @ J.T + self._damping, error)
        # All of the body but the legs moves with the base, so that a few ticks bring the centre of mass there.
        self._shift[:2] += com[:2] + com_shift - pin.centerOfMass(model, moved, pin.KinematicLevel.POSITION, False)[:2]


def _leg(robot: Robot, frame: int) -> Array:
    """Velocities of the joints between the base and a frame."""
    model = robot.model
    joints = [joint for joint in model.supports[model.frames[frame].parentJoint] if joint > 1]
    return np.array([model.idx_vs[joint] for joint in joints])


def leg_compliance(robot: Robot, servo: Servo) -> dict[str, Array]:
    """Compliance of each foot against the pelvis in roll, pitch [rad/(N m)] and height [m/N], (3,), at rest.

    The servos of its leg are in series, J kp⁻¹ Jᵀ.
    """
    data, compliance = robot.model.createData(), {}
    pin.computeJointJacobians(robot.model, data, robot.rest)
    pin.updateFramePlacements(robot.model, data)
    for foot in robot.feet:
        frame = robot.point(foot)
        leg = _leg(robot, frame)
        J = pin.getFrameJacobian(robot.model, data, frame, pin.LOCAL)[:, leg][[3, 4, 2]]
        compliance[foot] = J**2 @ (1.0 / servo.stiffness[leg - 6])
    return compliance
