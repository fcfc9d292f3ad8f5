"""The collision shapes of a robot and of things, and the pairs of them that may collide."""

from collections.abc import Sequence

import coal
import numpy as np
import pinocchio as pin

from sot.robots.system import System

Array = np.ndarray


def shapes_of(system: System) -> tuple[pin.GeometryModel, list[str | int], list[str]]:
    """Shapes and pairs of the robot, those with things after them; body (`System.body_of`) and owner of each shape.

    The pads in front of the robot's palms meet things, but no part of the robot.
    """
    geometry = system.robot.shapes.copy()
    bodies: list[str | int] = [int(shape.parentJoint) for shape in geometry.geometryObjects]
    if system.things:
        bodies += _add_pads(geometry, system)
    owners = ["robot"] * len(bodies)
    for thing in system.things:
        for number, (frame, solid) in enumerate(thing.solids):
            own = thing.model.frames[frame]
            joint = system.model.getJointId(thing.model.names[own.parentJoint]) if own.parentJoint else 0
            place, name = own.placement * solid.placement, solid.name or f"{thing.name}/{number}"
            geometry.addGeometryObject(pin.GeometryObject(name, joint, place, solid.coal()))
            bodies.append(joint or thing.name)
            owners.append(thing.name)
    moves = [owner == "robot" or isinstance(body, int) for owner, body in zip(owners, bodies, strict=True)]
    for second, owner in enumerate(owners):
        for first in range(second):
            if owner != "robot" and owners[first] != owner and (moves[first] or moves[second]):
                geometry.addCollisionPair(pin.CollisionPair(first, second))
    return geometry, bodies, owners


def bounding_balls(shapes: Sequence[pin.GeometryObject]) -> tuple[Array, Array]:
    """Centres in the shapes' own axes (n, 3), and radii (n,), of balls about shapes [m]."""
    for shape in shapes:
        shape.geometry.computeLocalAABB()
    centres = [shape.geometry.aabb_center for shape in shapes]
    return np.array(centres).reshape(-1, 3), np.array([shape.geometry.aabb_radius for shape in shapes])


def _add_pads(geometry: pin.GeometryModel, system: System) -> list[int]:
    """Add the pads in front of the robot's palms; returns their bodies."""
    bodies = []
    for name, surface in system.robot.surfaces.items():
        if name not in system.robot.feet and surface.point is not None:
            (half, place), frame = surface.pad(), system.model.frames[system.point(surface.point)]
            shape = pin.GeometryObject(name, frame.parentJoint, frame.placement * place, coal.Box(*(2.0 * half)))
            geometry.addGeometryObject(shape)
            bodies.append(int(frame.parentJoint))
    return bodies
