"""The torques that a planned motion needs: inverse dynamics, the floor's forces shared by the feet that stand."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.feet.contacts import Phase, phase_indices
from sot.robots.robot import Robot

Array = NDArray[np.float64]

PIVOT = 0.05  # m: a moment on a foot costs as much as a force at that distance


def planned_torques(robot: Robot, phases: Sequence[Phase], times: Array, q: Array, v: Array, a: Array) -> Array:
    """The torques (T, na) of the joints in a motion q (T, nq), v (T, nv), a (T, nv) at some times (T,) [N m].

    τ = S (M a + h − Σ Jᵀ w) + d v + c sign v: damping d and friction c of the joints, w the least wrenches on the feet
    of each time's phase that move the free base as planned. Where no foot stands, the base is left to itself.
    """
    model, data = robot.model, robot.model.createData()
    torques, phase = np.empty((len(times), robot.na)), phase_indices(phases, times)
    weight = np.repeat([1.0, PIVOT**2], 3)  # of forces and moments, inverse
    for k in range(len(times)):
        needed = pin.rnea(model, data, q[k], v[k], a[k]).copy()
        feet = [robot.point(foot) for foot in phases[int(phase[k])].feet]
        if feet:
            pin.computeJointJacobians(model, data, q[k])
            pin.updateFramePlacements(model, data)
            J = np.vstack([pin.getFrameJacobian(model, data, foot, pin.LOCAL_WORLD_ALIGNED) for foot in feet])
            base, share = J[:, :6].T, np.tile(weight, len(feet))
            needed -= J.T @ (share * (base.T @ np.linalg.solve((base * share) @ base.T, needed[:6])))
        torques[k] = needed[6:]
    return torques + robot.damping * v[:, 6:] + robot.friction * np.sign(v[:, 6:])
