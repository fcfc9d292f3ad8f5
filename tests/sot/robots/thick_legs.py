"""HRP-2 with thicker thighs and shanks."""

from dataclasses import replace

import coal
import numpy as np
import pinocchio as pin

from sot.robots.robot import Robot


def with_thick_legs(robot: Robot, more: float) -> Robot:
    """The robot with capsules about its thighs and shanks whose radius is greater by a length [m]."""
    shapes = robot.shapes.copy()
    for shape in shapes.geometryObjects:
        if shape.name.startswith(("RLEG2", "LLEG2", "RLEG3", "LLEG3")):
            shape.geometry = coal.Capsule(shape.geometry.radius + more, 2.0 * shape.geometry.halfLength)
    results = shapes.createData()
    pin.computeDistances(robot.model, robot.model.createData(), shapes, results, robot.rest)
    distances = np.array([result.min_distance for result in results.distanceResults])
    return replace(robot, shapes=shapes, rest_distances=distances)
