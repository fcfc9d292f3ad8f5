"""Arms that keep clear of the rest of the body."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.coordinates import to_configuration
from sot.motion.kinematics import Chains, Kinematics
from sot.motion.parts import Arm, Indices
from sot.motion.targets import Targets
from sot.robot import Robot

Array = NDArray[np.float64]

ROOM = 0.02  # m, distance that an arm keeps from the rest of the body
CLEAR = 1.0 / 0.003  # 1/m, weight of what is missing of it


class Clearance:
    """Signed distances from each shape of an arm to the nearest shape of the rest of the body.

    Pairs that are less than ROOM apart at rest, neighbours in the tree mostly, do not count.
    """

    def __init__(self, robot: Robot, side: str, columns: Indices):
        """columns: of y, that Jacobians are with respect to."""
        self._model, self._columns = robot.model, columns
        self._chains = Chains(robot)
        self._data = robot.model.createData()
        joints = {2 + joint for joint in robot.groups[f"{side}_arm"]}
        shapes = list(enumerate(robot.shapes.geometryObjects))
        self._own = [k for k, shape in shapes if shape.parentJoint in joints]
        others = [k for k, shape in shapes if shape.parentJoint not in joints]
        self._geometry = robot.shapes.copy()
        self._geometry.removeAllCollisionPairs()
        for own in self._own:
            for other in others:
                self._geometry.addCollisionPair(pin.CollisionPair(other, own))
        self._make_room()
        for k in np.flatnonzero(self._distances(robot.rest) < ROOM)[::-1]:
            self._geometry.removeCollisionPair(self._geometry.collisionPairs[int(k)])
        self._make_room()
        owners = np.array([pair.second for pair in self._geometry.collisionPairs])
        self._pairs = [np.flatnonzero(owners == own) for own in self._own]

    def evaluate(self, y: Array) -> tuple[Array, Array]:
        """What is missing of ROOM (n, shapes) [m], 0 where nothing is, and its Jacobian (n, shapes, s)."""
        missing = np.zeros((len(y), len(self._own)))
        normals, points = np.zeros((2, *missing.shape, 3))
        for k, q in enumerate(to_configuration(y)):
            apart = self._distances(q)
            if apart.min(initial=np.inf) >= ROOM:
                continue
            for i, pairs in enumerate(self._pairs):
                if len(pairs) and (least := apart[pairs].min()) < ROOM:
                    nearest = self._each[pairs[apart[pairs].argmin()]]
                    missing[k, i] = ROOM - least
                    normals[k, i], points[k, i] = nearest.normal, nearest.getNearestPoint2()
        J = np.zeros((*missing.shape, len(self._columns)))
        for i, own in enumerate(self._own):
            near = np.flatnonzero(missing[:, i])
            if len(near):
                joint = self._geometry.geometryObjects[own].parentJoint
                moved = Kinematics(self._chains, y[near], self._columns).moved(joint, points[near, i])
                J[near, i] = -np.einsum("ni,nis->ns", normals[near, i], moved)
        return missing, J

    def _make_room(self) -> None:
        self._results = self._geometry.createData()
        self._each = list(self._results.distanceResults)  # views: looking them up costs more than the distances

    def _distances(self, q: Array) -> Array:
        pin.computeDistances(self._model, self._data, self._geometry, self._results, q)
        return np.array([result.min_distance for result in self._each])


class ClearArm(Arm):
    """An arm as it is to point, pushed off the rest of the body where it comes nearer than ROOM."""

    def __init__(self, robot: Robot, side: str, targets: Targets):
        super().__init__(robot, side, targets)
        self._clearance = Clearance(robot, side, self.columns)

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        errors, jacobians = super().evaluate(knots, y)
        missing, J = self._clearance.evaluate(y)
        return np.hstack([errors, CLEAR * missing]), np.concatenate([jacobians, CLEAR * J], axis=1)
