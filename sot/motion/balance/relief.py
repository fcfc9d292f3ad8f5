"""A posture that relieves motors: on one foot, hips and trunk lean to where what stands on it overloads no joint."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.body.coordinates import rate_matrix, to_pinocchio, to_rotation
from sot.motion.body.parts import Part
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import Phase, phase_indices
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

RELIEVED = 0.9  # of a joint's effort, that a plan may take where its posture can be changed for it
ACCEPTED = 0.05  # of its effort, beyond that


class RelievedBody:
    """A body whose leg, where it stands alone, holds it with less than its motors' effort.

    With the wrench w of the floor on the standing foot, which the motion of the centre of mass decides, the torques are
    τ = S (M a + h - Jᵀ w). Where one is beyond RELIEVED of its effort the excess is an error. It changes with the
    posture by ∂(g(q) - Jᵀ w)/∂q at that w; what M a and C v change by is left out.
    """

    def __init__(self, body: Part, robot: Robot, phases: Sequence[Phase], body_motion: Spline):
        """
        Args:
            body: to be relieved, evaluated at the knots of `body_motion`.
            robot: whose it is.
            phases: which foot stands where, when.
            body_motion: all of it.
        """
        self.columns = body.columns
        self._body, self._robot, self._phases, self._motion = body, robot, phases, body_motion
        self._legs = np.array(robot.groups["legs"], dtype=int)

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        errors, jacobians = self._body.evaluate(knots, y)
        excess, J = self.excess(knots)
        return np.hstack([errors, excess]), np.concatenate([jacobians, J[:, :, self.columns]], axis=1)

    def excess(self, knots: Indices) -> tuple[Array, Array]:
        """The weighted errors (n, legs) of the legs' torques at some knots, and their Jacobians (n, legs, nv) by the
        coordinates."""
        robot, model, data, legs = self._robot, self._robot.model, self._robot.model.createData(), self._legs
        motion = self._motion
        y = motion.knots[knots]
        moving = to_pinocchio(y, motion.velocities[knots], motion.accelerations[knots])
        errors, jacobians = np.zeros((len(y), len(legs))), np.zeros((len(y), len(legs), robot.nv))
        effort, phase = robot.effort[legs], phase_indices(self._phases, motion.period * knots.astype(float))
        forces = [pin.Force.Zero() for _ in range(model.njoints)]
        for n, (q, v, a) in enumerate(zip(*moving, strict=True)):
            feet = list(self._phases[int(phase[n])].feet)
            if len(feet) != 1:
                continue
            frame = model.frames[robot.point(feet[0])]
            needed = pin.rnea(model, data, q, v, a).copy()
            J = pin.computeFrameJacobian(model, data, q, robot.point(feet[0]), pin.LOCAL)
            wrench = np.linalg.solve(J[:, :6].T, needed[:6])
            torques = (needed - J.T @ wrench)[6:][legs]
            beyond = np.abs(torques) - RELIEVED * effort
            over = np.flatnonzero(beyond > 0.0)
            if not len(over):
                continue
            forces[frame.parentJoint] = frame.placement.act(pin.Force(wrench))
            slope = pin.computeStaticTorqueDerivatives(model, data, q, forces)[6 + legs[over]].copy()
            forces[frame.parentJoint] = pin.Force.Zero()
            slope[:, :3] = slope[:, :3] @ to_rotation(y[n : n + 1, 3:6])[0].T
            slope[:, 3:6] = slope[:, 3:6] @ rate_matrix(y[n : n + 1, 3:6])[0]
            weight = np.sign(torques[over]) / (ACCEPTED * effort[over])
            errors[n, over] = beyond[over] / (ACCEPTED * effort[over])
            jacobians[n, over] = weight[:, None] * slope
        return errors, jacobians
