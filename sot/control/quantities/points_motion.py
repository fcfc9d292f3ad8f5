"""Where some points of a robot are, and how they move: Pinocchio places the joints, compiled functions do the rest."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.control.quantities.frames import moving_velocities, write_point_motion
from sot.rotation import rotation_vector

Array = NDArray[np.float64]


class PointsMotion:
    """Motion of frames, one after the other, world axes; its arrays are written anew for each state.

    Args:
        model: Pinocchio's.
        frames: n of them.
        data: Pinocchio's, to be used.

    Attributes:
        positions, rotations: of the frames (n, 3), (n, 3, 3) [m].
        jacobian: of all frames, linear over angular velocities, on Pinocchio's velocities (6 n, nv).
        drift: their accelerations when v̇ is zero (6 n,), of the last `move`.
    """

    def __init__(self, model: pin.Model, frames: Sequence[int], data: pin.Data) -> None:
        self._model, self._frames, self._data, count = model, tuple(frames), data, len(frames)
        self.positions, self.rotations = np.empty((count, 3)), np.empty((count, 3, 3))
        self.jacobian, self.drift = np.zeros((6 * count, model.nv)), np.zeros(6 * count)
        self._velocity, self._still, self._q = np.zeros(6 * count), np.zeros(model.nv), np.full(model.nq, np.nan)
        self._J = data.J  # a live view, as those of the frames
        self._places = [(data.oMf[frame].translation, data.oMf[frame].rotation) for frame in frames]
        self._moving = [moving_velocities(model, frame) for frame in frames]
        self._rows = [slice(6 * k, 6 * k + 6) for k in range(count)]

    def place(self, q: Array) -> None:
        """Go to a configuration (nq,), and write positions, rotations and Jacobian there."""
        if np.array_equal(q, self._q):
            return
        self._q = q.copy()
        pin.computeJointJacobians(self._model, self._data, q)
        for k, frame in enumerate(self._frames):
            pin.updateFramePlacement(self._model, self._data, frame)
            self.positions[k], self.rotations[k] = self._places[k]
        self.move(self._still)

    def move(self, v: Array) -> None:
        """Write the drift of a velocity (nv,) at the configuration of the last `place`."""
        for k, own in enumerate(self._rows):
            at, velocity, jacobian = self.positions[k], self._velocity[own], self.jacobian[own]
            write_point_motion(self._J, v, *self._moving[k], at, velocity, jacobian, self.drift[own])


@compiled
def turn_between(rotation: Array, other: Array) -> Array:
    """The turn (3,) that takes another rotation (3, 3) to a rotation (3, 3), world axes [rad]."""
    R = np.zeros((3, 3))
    for i in range(3):
        for k in range(3):
            for m in range(3):
                R[i, k] += rotation[i, m] * other[k, m]
    return rotation_vector(R)


@compiled
def pose_errors(positions: Array, rotations: Array, to: Array, turned: Array) -> Array:
    """How far poses (n, 3), (n, 3, 3) are off others: positions over turns, one after the other (6 n,) [m, rad]."""
    e = np.empty(6 * len(positions))
    for k in range(len(positions)):
        e[6 * k : 6 * k + 3] = positions[k] - to[k]
        e[6 * k + 3 : 6 * k + 6] = turn_between(rotations[k], turned[k])
    return e
