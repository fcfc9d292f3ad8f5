"""A robot and the things that it handles as one mechanism: what one quadratic program knows the dynamics of."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface, named_surface
from sot.robots.things.thing import Thing

Array = np.ndarray


class System:
    """A robot and things in one Pinocchio model, the things' joints after the robot's, whose indices stay.

    Otani (17)-(21). A robot alone is a system too, of the robot's own model. Immutable; whatever asks a robot for its
    points, surfaces or number of velocities can ask a system instead.

    Args:
        robot: The robot.
        things: In the order in which their joints follow the robot's; names differ. Things that do not move have no
            joints in it: their surfaces are the world's.

    Attributes:
        model: Pinocchio's.
        nq, nv, na: Numbers of coordinates, of velocities and of motors, the robot's first.
        rest: Configuration with the robot at rest and the things in their places (nq,).
        joints: Names of the joints with motors (na,).
        effort: Limits of the motors (na,) [N m].
        driven: Velocities that have a motor (na,).
        undriven: Velocities that have none, the robot's base first.
        points: Operational point -> Pinocchio frame, of the robot and of the things.
        surfaces: Name -> surface, those of all things and the floor's included.

    Raises:
        InputError: Two things, or a thing and a point of the robot, have the same name.
    """

    def __init__(self, robot: Robot, things: Sequence[Thing] = ()) -> None:
        self.robot, self.things = robot, tuple(things)
        names = [*robot.points, *(thing.name for thing in self.things)]
        for thing in self.things:
            if names.count(thing.name) > 1 or thing.name in ("robot", FLOOR.name):
                raise InputError(f"the name '{thing.name}' is taken: give the thing another one (name=...)")
        points, surfaces = dict(robot.points), {FLOOR.name: FLOOR, **robot.surfaces}
        self.coordinates: dict[str, slice] = {}
        self.velocities: dict[str, slice] = {}
        moving = [thing for thing in self.things if thing.nv]
        self.model = robot.model if not moving else pin.Model(robot.model)
        for thing in self.things:
            surfaces |= {surface.name: surface for surface in thing.surfaces.values()}
            if thing.nv:
                q, v = self.model.nq, self.model.nv
                points |= _append(self.model, thing)
                self.coordinates[thing.name] = slice(q, self.model.nq)
                self.velocities[thing.name] = slice(v, self.model.nv)
        self.nq, self.nv = self.model.nq, self.model.nv
        self.points: Mapping[str, int] = MappingProxyType(points)
        self.surfaces: Mapping[str, Surface] = MappingProxyType(surfaces)
        self.rest = np.concatenate([robot.rest, *(thing.rest for thing in moving)])
        effort = np.concatenate([robot.effort, *(thing.effort for thing in moving)])
        driven = np.concatenate([np.zeros(6, bool), np.ones(robot.na, bool), *(thing.effort > 0.0 for thing in moving)])
        self.driven, self.undriven = np.flatnonzero(driven), np.flatnonzero(~driven)
        self.na, self.effort = len(self.driven), effort[driven[6:]]
        self.joints = (*robot.joints, *(self.model.names[self._joint_of(k)] for k in self.driven[robot.na :]))
        for array in (self.rest, self.effort, self.driven, self.undriven):
            array.setflags(write=False)

    @staticmethod
    def of(robot: "Robot | System") -> "System":
        """A robot alone as a system; a system as it is."""
        return robot if isinstance(robot, System) else System(robot)

    @property
    def moving_things(self) -> tuple[Thing, ...]:
        """Things that have joints."""
        return tuple(thing for thing in self.things if thing.nv)

    def thing(self, name: str) -> Thing:
        """The thing of a name.

        Raises:
            InputError: There is none.
        """
        for thing in self.things:
            if thing.name == name:
                return thing
        raise InputError(f"there is no thing '{name}': there are {', '.join(t.name for t in self.things) or 'none'}")

    def point(self, name: str) -> int:
        """Pinocchio frame of an operational point of the robot or of a thing: "box", or "box/site".

        Raises:
            InputError: There is no such point.
        """
        try:
            return self.points[name]
        except KeyError:
            known = ", ".join(self.points)
            raise InputError(f"there is no point '{name}': choose one of {known}") from None

    def surface(self, name: str) -> Surface:
        """A surface of the robot ("right_palm"), of a thing ("box/left"), or "floor".

        Raises:
            InputError: There is no such surface.
        """
        return named_surface(self.surfaces, name, "there is")

    def body_of(self, surface: Surface) -> int | str:
        """What a surface is of: the joint that moves it, or the name of a thing that does not move; or the floor."""
        return surface.owner if surface.point is None else int(self.model.frames[self.point(surface.point)].parentJoint)

    def joint_numbers(self, joints: str | Sequence[str]) -> Array:
        """Numbers of the robot's joints of a group, or of some that are named (see `Robot.joint_numbers`)."""
        return self.robot.joint_numbers(joints)

    def _joint_of(self, velocity: int) -> int:
        return int(np.searchsorted(self.model.idx_vs, velocity, side="right")) - 1


def _append(model: pin.Model, thing: Thing) -> dict[str, int]:
    """Append a thing's joints, bodies and frames to a model, under the universe; returns its points."""
    theirs, joints = thing.model, {0: 0}
    for k in range(1, theirs.njoints):
        joint = joints[k] = model.addJoint(
            joints[theirs.parents[k]], theirs.joints[k], theirs.jointPlacements[k], theirs.names[k]
        )
        model.appendBodyToJoint(joint, theirs.inertias[k], pin.SE3.Identity())
        own, there = model.idx_vs[joint], theirs.idx_vs[k]
        for name in ("armature", "damping", "upperDryFrictionLimit", "lowerDryFrictionLimit"):
            getattr(model, name)[own : own + theirs.nvs[k]] = getattr(theirs, name)[there : there + theirs.nvs[k]]
    points: dict[str, int] = {}
    frames = {frame: point for point, frame in thing.points.items()}
    for k, frame in enumerate(theirs.frames):
        if k in frames:
            added = pin.Frame(frame.name, joints[frame.parentJoint], 0, frame.placement, pin.FrameType.OP_FRAME)
            number = model.addFrame(added, False)
            points |= {point: number for point, own in thing.points.items() if own == k}
    return points
