"""A posture that relieves motors: on one foot, hips and trunk lean to where what stands on it overloads no joint."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.body.coordinates import rate_matrix, to_configuration, to_rotation
from sot.motion.body.parts import Part
from sot.motion.feet.contacts import Phase, phase_indices
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

MAX_STILL_EFFORT_SHARE = 0.75  # of a joint's effort, that holding still may take: the rest is for the motion
ACCEPTED_EXCESS_SHARE = 0.05  # of its effort, beyond that


class RelievedBody:
    """A body that a leg, where it stands alone, can hold still with less than the effort of its hip and knee.

    With the wrench w that the floor has for that on the foot, the torques are τ = S (g(q) - Jᵀ w). Where one is beyond
    MAX_STILL_EFFORT_SHARE of its effort the excess is an error, which changes with the posture by ∂τ/∂q at that w: with
    the centre of mass w changes as well, but the balance decides that. An ankle's torque is the zero moment point's.
    """

    def __init__(self, body: Part, robot: Robot, phases: Sequence[Phase], period: float):
        """
        Args:
            body: to be relieved.
            robot: whose it is.
            phases: which foot stands where, when.
            period: time between knots [s].
        """
        self.columns = body.columns
        self._body, self._robot, self._phases, self._period = body, robot, phases, period
        self._joints = np.array(
            [
                joint
                for side in SIDES
                for joint in robot.groups[f"{side}_leg"]
                if joint in _joints_to(robot, f"{side}_knee")
            ]
        )

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        errors, jacobians = self._body.evaluate(knots, y)
        excess, J = self.excess(knots, y)
        return np.hstack([errors, excess]), np.concatenate([jacobians, J[:, :, self.columns]], axis=1)

    def excess(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        """The weighted errors (n, s) of the torques of hips and knees at some knots, and their Jacobians (n, s, nv) by
        the coordinates y (n, nv)."""
        model, data, joints = self._robot.model, self._robot.model.createData(), self._joints
        errors, jacobians = np.zeros((len(y), len(joints))), np.zeros((len(y), len(joints), model.nv))
        effort, phase = self._robot.effort[joints], phase_indices(self._phases, self._period * knots.astype(float))
        turned, rates = to_rotation(y[:, 3:6]), rate_matrix(y[:, 3:6])
        forces = [pin.Force.Zero() for _ in range(model.njoints)]
        for n, q in enumerate(to_configuration(y)):
            feet = list(self._phases[int(phase[n])].feet)
            if len(feet) != 1:
                continue
            foot = self._robot.point(feet[0])
            gravity = pin.computeGeneralizedGravity(model, data, q).copy()
            J = pin.computeFrameJacobian(model, data, q, foot, pin.LOCAL)
            wrench = np.linalg.solve(J[:, :6].T, gravity[:6])
            torques = (gravity - J.T @ wrench)[6:][joints]
            over = np.flatnonzero(np.abs(torques) > MAX_STILL_EFFORT_SHARE * effort)
            if not len(over):
                continue
            frame, weight = model.frames[foot], np.sign(torques[over]) / (ACCEPTED_EXCESS_SHARE * effort[over])
            forces[frame.parentJoint] = frame.placement.act(pin.Force(wrench))
            slope = pin.computeStaticTorqueDerivatives(model, data, q, forces)[6 + joints[over]].copy()
            forces[frame.parentJoint] = pin.Force.Zero()
            slope[:, :3] = slope[:, :3] @ turned[n].T
            slope[:, 3:6] = slope[:, 3:6] @ rates[n]
            errors[n, over] = weight * (torques[over] - np.sign(torques[over]) * MAX_STILL_EFFORT_SHARE * effort[over])
            jacobians[n, over] = weight[:, None] * slope
        return errors, jacobians


def _joints_to(robot: Robot, point: str) -> set[int]:
    """The joints between the base and a point."""
    chain = robot.model.supports[robot.model.frames[robot.point(point)].parentJoint]
    return {joint - 2 for joint in chain if joint > 1}
