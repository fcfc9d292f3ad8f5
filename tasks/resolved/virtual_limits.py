"""Virtual joint limits, Dariush 4.6.1: ranges within which neighbouring links do not meet."""

import numpy as np
import pinocchio as pin

from sot.robots.robot import Robot

Array = np.ndarray

SWEEP_STEPS = 90
"""Number of angles at which a joint's range is looked at, to either side."""
TOUCHING_DISTANCE = 0.005
"""Links that are nearer at rest are made to touch [m]: they do not count."""


def virtual_limits(robot: Robot) -> tuple[Array, Array]:
    """The part of each joint's range, around rest, in which the two links that it connects do not overlap.

    The other joints are at rest. The paper finds these bounds by hand.

    Returns:
        Lower and upper limits, shapes (na,) [rad], within the robot's own.
    """
    shapes = robot.shapes.copy()
    lower, upper = robot.lower.copy(), robot.upper.copy()
    for joint in range(robot.na):
        child, parent = joint + 2, robot.model.parents[joint + 2]
        shapes.removeAllCollisionPairs()
        for first, a in enumerate(shapes.geometryObjects):
            for second, b in enumerate(shapes.geometryObjects):
                if a.parentJoint == parent and b.parentJoint == child:
                    shapes.addCollisionPair(pin.CollisionPair(first, second))
        least = _least_distances(robot, shapes, joint, np.array([robot.rest[7 + joint]]))
        if not len(shapes.collisionPairs) or not least[0] > TOUCHING_DISTANCE:
            continue
        for ends, target in ((lower, robot.lower[joint]), (upper, robot.upper[joint])):
            angles = np.linspace(robot.rest[7 + joint], target, SWEEP_STEPS)
            met = np.flatnonzero(_least_distances(robot, shapes, joint, angles) <= 0.0)
            if len(met):
                ends[joint] = angles[met[0] - 1]
    return lower, upper


def _least_distances(robot: Robot, shapes: pin.GeometryModel, joint: int, angles: Array) -> Array:
    """Least distance of all pairs of shapes at each angle of one joint, the others at rest, shape (n,) [m]."""
    data, results, q = robot.model.createData(), shapes.createData(), robot.rest.copy()
    least = np.full(len(angles), np.inf)
    for k, angle in enumerate(angles):
        q[7 + joint] = angle
        pin.computeDistances(robot.model, data, shapes, results, q)
        least[k] = min((result.min_distance for result in results.distanceResults), default=np.inf)
    return least
