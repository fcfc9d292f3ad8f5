"""A demonstration with objects in the robot's size: where its hands, its feet and the things that it gets are to be.

What is retargeted is the hand relative to the object: where it touches counts in shares of the object's own size, and
so the same demonstration serves a robot and a box of any size.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.feet.stance import LEAD_IN_TIME, Build
from sot.motion.human.human import Human
from sot.motion.objects.com_path import PlacePath, com_path
from sot.motion.objects.demonstration import HandledObjects
from sot.motion.objects.detection import palm_path
from sot.motion.objects.events import ROBOT, WORLD, ContactEvent, ContactPlan, SurfaceName
from sot.motion.objects.pose_path import PosePath, blended
from sot.motion.objects.pushing import joint_path
from sot.motion.trajectory import Motion
from sot.robots.surface import Surface
from sot.robots.system import System
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

HAND_STANDOFF = 0.16  # leg lengths: distance from which a hand approaches a surface, and to which it withdraws
OTHER_STANDOFF = 0.05  # leg lengths: the same of a foot, or of a thing that is set down
REACHING_TIME = 5.0  # √(leg / g): time in which a hand's path goes over from the body's to the object's


@dataclass(frozen=True)
class Target:
    """Where what makes a contact is to touch.

    Attributes:
        mover: Point that is led: of the robot, or a thing.
        body: Point that it is led to, a thing's; None for the world.
        place: Placement of the mover relative to that body, or in the world, when the surfaces touch.
        normal: Outward normal of the surface that is touched, in the body's axes (3,).
        standoff: Distance from which it approaches [m].
    """

    mover: str
    body: str | None
    place: pin.SE3
    normal: Array
    standoff: float

    def away(self, body: pin.SE3, distance: float) -> pin.SE3:
        """The mover's placement in the world at a distance [m] off the surface of a body that is at a placement."""
        placement = body * self.place
        return pin.SE3(placement.rotation, placement.translation + distance * (body.rotation @ self.normal))

    def gap(self, body: pin.SE3, mover: pin.SE3) -> float:
        """How far a mover at a placement in the world is off where it touches, along the surface's normal [m]."""
        return float((body.rotation @ self.normal) @ (mover.translation - self.away(body, 0.0).translation))


@dataclass(frozen=True)
class RobotDemonstration:
    """A demonstration for a robot and its things, on the motion's time line.

    Attributes:
        system: The robot and the things.
        motion: The body's motion, which nothing balances.
        contacts: The contacts at the start, and the events.
        surfaces: Of the system, by their names in the events.
        links: Paths of the robot's points that touch something at some time, while they are free.
        things: Paths of the things that move.
        targets: Of all contacts that are made: event -> where.
        com: Path of the centre of mass over each set of supports of the robot: those of its surfaces on the world.
    """

    system: System
    motion: Motion
    contacts: ContactPlan
    surfaces: Mapping[SurfaceName, Surface]
    links: Mapping[str, PosePath]
    things: Mapping[str, PosePath]
    targets: Mapping[ContactEvent, Target]
    com: Mapping[frozenset[str], PlacePath]

    def surface(self, name: SurfaceName) -> Surface:
        """The surface of the system that an event names."""
        return self.surfaces[name]


@dataclass(frozen=True)
class Scale:
    """A human's world in the robot's size: heights from the floor, places from the middle of the ankles.

    Attributes:
        factor: Robot's length over the human's.
        human, robot: Middle of the ankles at the start (2,) [m].
    """

    factor: float
    human: Array
    robot: Array

    @classmethod
    def of(cls, human: Human, build: Build) -> "Scale":
        """From a human, whose clip starts standing, to a robot."""
        ankles = np.mean([human.points[f"{side}_ankle"][0, :2] for side in ("left", "right")], axis=0)
        return cls(build.leg / human.leg, ankles, build.ankles[:2])

    def __call__(self, points: Array) -> Array:
        """Points (..., 3) of the human's world in the robot's [m]."""
        scaled = self.factor * np.asarray(points, dtype=float)
        scaled[..., :2] += self.robot - self.factor * self.human
        return scaled


def retarget_objects(
    human: Human,
    handled: HandledObjects,
    contacts: ContactPlan,
    motion: Motion,
    system: System,
    palms: Mapping[str, str],
) -> RobotDemonstration:
    """The demonstration of a human with objects for a robot with things of the same names.

    Args:
        human: The human, in its own size.
        handled: Its objects.
        contacts: What touches when, in the clip's time.
        motion: The robot's motion after the human, with its lead-in.
        system: The robot and the things; what is fixed carries a surface "top" for things to lie on.
        palms: Name of a link in the events -> the robot's surface; soles are called as in the events.

    Raises:
        InputError: An event names a surface that is not there, or a thing of the demonstration is missing.
    """
    return _Retargeting(human.resampled(handled.rate), handled, contacts, motion, system, palms).demonstration()


class _Retargeting:
    def __init__(
        self,
        human: Human,
        handled: HandledObjects,
        contacts: ContactPlan,
        motion: Motion,
        system: System,
        palms: Mapping[str, str],
    ) -> None:
        self.human, self.handled, self.motion, self.system = human, handled, motion, system
        build = Build.of(system.robot)
        self.scale, self.leg = Scale.of(human, build), build.leg
        self.reaching = REACHING_TIME * float(np.sqrt(build.leg / GRAVITY))
        self.count = min(human.count, *(len(path.position) for path in handled.objects.values()))
        self.times = LEAD_IN_TIME + np.arange(self.count) / handled.rate
        self.surfaces = dict(named_surfaces(system, palms))
        contacts.check_surfaces(self.surfaces)
        self.contacts = ContactPlan(
            contacts.initial, tuple(replace(event, time=event.time + LEAD_IN_TIME) for event in contacts.events)
        )

    def demonstration(self) -> RobotDemonstration:
        things: dict[str, PosePath] = {}
        targets: dict[ContactEvent, Target] = {}
        for name in self.handled.objects:
            if name not in {thing.name for thing in self.system.moving_things}:
                raise InputError(f"the demonstration handles '{name}': put a thing of that name into the world")
            things[name] = (
                self._hinged_path(name) if self.handled.objects[name].hinged else self._free_path(name, targets)
            )
        links: dict[str, PosePath] = {}
        for pair in self.contacts.pairs():
            if pair.first.entity == ROBOT:
                point = self._point(pair.first)
                if point not in links:
                    links[point] = self._link_path(point, pair.first, things, targets)
        return RobotDemonstration(
            self.system, self.motion, self.contacts, self.surfaces, links, things, targets, self._com_paths(targets)
        )

    def _point(self, name: SurfaceName) -> str:
        point = self.surfaces[name].point
        if point is None:
            raise InputError(f"{name} does not move: name what moves first")
        return point

    def _hinged_path(self, name: str) -> PosePath:
        """The path of a thing on a hinge, which turns as far as the human's does."""
        thing, path = self.system.thing(name), self.handled.objects[name]
        data, frame = thing.model.createData(), thing.points[name]
        position, rotation = np.empty((self.count, 3)), np.empty((self.count, 3, 3))
        for k, coordinate in enumerate(joint_path(thing, path)[: self.count].tolist()):
            pin.framesForwardKinematics(thing.model, data, np.array([coordinate]))
            position[k], rotation[k] = data.oMf[frame].translation, data.oMf[frame].rotation
        return PosePath.through(self.times, position, rotation, self.motion.rate)

    def _free_path(self, name: str, targets: dict[ContactEvent, Target]) -> PosePath:
        """The path of a free thing, from where it is to where it is set down, a little above it."""
        path, rest = self.handled.objects[name], self._rest(name)
        position = self.scale(path.position[: self.count])
        turned = path.rotation[: self.count] @ path.rotation[0].T @ rest.rotation
        low, _ = _extent(self.system, name)
        known, corrections = [self.times[0]], [rest.translation - position[0]]
        lifts = np.zeros(self.count)
        standoff = OTHER_STANDOFF * self.leg
        for event in self._made(name):
            k = self._frame(event.time)
            surface = self.surfaces[event.pair.second]
            place = position[k].copy()
            place[2] = surface.placement.translation[2] - low[2]
            known.append(event.time)
            corrections.append(place - position[k])
            normal = surface.placement.rotation[:, 2]
            targets[event] = Target(name, None, pin.SE3(turned[k], place), normal, standoff)
            lifts += standoff * self._rising(event.time)
        position = position + _interpolated(self.times, np.array(known), np.array(corrections))
        position[:, 2] += lifts
        return PosePath.through(self.times, position, turned, self.motion.rate)

    def _link_path(
        self, point: str, name: SurfaceName, things: Mapping[str, PosePath], targets: dict[ContactEvent, Target]
    ) -> PosePath:
        """The path of a link while it is free: the body's, and near a contact the one that leads to it."""
        surface = self.surfaces[name]
        own = list(self._own_path(point, name))
        for made in (event for event in self.contacts.events if event.change == "make" and event.pair.first == name):
            path = things.get(made.pair.second.entity)
            standoff = (OTHER_STANDOFF if path is None else HAND_STANDOFF) * self.leg
            target = targets[made] = self._target(made, point, surface, path, own[self._frame(made.time)], standoff)
            bodies = [pin.SE3.Identity() if path is None else path.placement(t) for t in self.times.tolist()]
            own = self._kept_off(own, target, bodies, made.time)
            beside = [target.away(body, standoff) for body in bodies]
            share = np.minimum(self._rising(made.time), self._falling(self._released(made)))
            position, rotation = blended(own, beside, share)
            own = [pin.SE3(turn, place) for place, turn in zip(position, rotation, strict=True)]
        position, rotation = np.array([one.translation for one in own]), np.array([one.rotation for one in own])
        return PosePath.through(self.times, position, rotation, self.motion.rate)

    def _kept_off(
        self, own: Sequence[pin.SE3], target: Target, bodies: Sequence[pin.SE3], time: float
    ) -> list[pin.SE3]:
        """A link's places, no nearer than the standoff to the plane that it will touch while it reaches for it."""
        soon = np.where(self.times < time, minimum_jerk((self.times - time) / self.reaching + 2.0), 0.0)
        kept = []
        for placement, body, share in zip(own, bodies, soon.tolist(), strict=True):
            push = share * max(target.standoff - target.gap(body, placement), 0.0)
            kept.append(pin.SE3(placement.rotation, placement.translation + push * (body.rotation @ target.normal)))
        return kept

    def _own_path(self, point: str, name: SurfaceName) -> Iterator[pin.SE3]:
        """Places of a link that nothing leads but the human: a foot's go with the ankle from where it stands."""
        reference = self.motion.pose(point)
        if point not in self.system.robot.feet:
            for t in self.times.tolist():
                pose = reference(t)
                yield pin.SE3(pose.rotation, pose.position)
            return
        stands, ankle = reference(0.0), self.human.points[point.replace("foot", "ankle")]
        for k, t in enumerate(self.times.tolist()):
            shift = np.zeros(3)
            if name.surface not in self.contacts.sets_at(t, ()).supports:
                shift = self.scale.factor * (ankle[k] - ankle[0])
            yield pin.SE3(stands.rotation, stands.position + shift)

    def _target(
        self,
        event: ContactEvent,
        point: str,
        surface: Surface,
        path: PosePath | None,
        near: pin.SE3,
        standoff: float,
    ) -> Target:
        """Where a link's surface touches another one, its turn about the normal the one that it has anyway."""
        other = self.surfaces[event.pair.second]
        body = pin.SE3.Identity() if path is None else path.placement(event.time)
        face = body * other.placement
        now = near * surface.placement
        spot = now.translation if path is None else body.act(self._spot_on_thing(event))
        local = face.actInv(spot)
        half = np.abs(surface.corners).max(axis=0)
        if len(other.corners):
            low, high = other.corners.min(axis=0) + half, other.corners.max(axis=0) - half
            middle = 0.5 * (low + high)
            local = np.clip(local, np.minimum(low, middle), np.maximum(high, middle))
        local[2] = 0.0
        turn = pin.Quaternion.FromTwoVectors(now.rotation[:, 2], -face.rotation[:, 2]).toRotationMatrix()
        touching = pin.SE3(turn @ now.rotation, face.act(local)) * surface.placement.inverse()
        return Target(
            point,
            None if path is None else event.pair.second.entity,
            body.inverse() * touching,
            body.rotation.T @ face.rotation[:, 2],
            standoff,
        )

    def _com_paths(self, targets: Mapping[ContactEvent, Target]) -> dict[frozenset[str], PlacePath]:
        """The centre of mass over each set of supports that there is at some time."""
        places = {point: self.motion.pose(point)(0.0) for point in self.system.robot.feet}
        standing = {point: pin.SE3(pose.rotation, pose.position) for point, pose in places.items()}
        standing |= {event.pair.first.surface: target.place for event, target in targets.items() if target.body is None}
        paths: dict[frozenset[str], PlacePath] = {}
        for count in range(len(self.contacts.events) + 1):
            supports = self.contacts.sets_after(count, ()).supports
            if supports and supports not in paths:
                corners = {}
                for name in sorted(supports):
                    own = self.surfaces[SurfaceName(ROBOT, name)].corners_at_point
                    corners[name] = np.array([standing[name].act(corner)[:2] for corner in own])
                middles = {name: own.mean(axis=0) for name, own in corners.items()}
                paths[supports] = com_path(
                    self.human, LEAD_IN_TIME, middles, corners.values(), self.motion.rate, self.leg
                )
        return paths

    def _spot_on_thing(self, event: ContactEvent) -> Array:
        """Where the human's palm touches, on the robot's thing, in the thing's axes: in shares of its size.

        A door's height is the human's as the floor has it, in the robot's size.
        """
        path, k = self.handled.objects[event.pair.second.entity], self._frame(event.time)
        palm = palm_path(self.human, event.pair.first.surface.removesuffix("_hand"))[: self.count]
        share = path.local(palm)[k] / path.size + 0.5
        low, high = _extent(self.system, event.pair.second.entity)
        spot = low + share * (high - low)
        if path.hinged:
            spot[2] = self.scale.factor * palm[k, 2] - self._rest(event.pair.second.entity).translation[2]
        return spot

    def _rest(self, name: str) -> pin.SE3:
        """Where a thing is at rest."""
        thing = self.system.thing(name)
        data = thing.model.createData()
        pin.framesForwardKinematics(thing.model, data, thing.rest)
        return data.oMf[thing.points[name]].copy()

    def _made(self, name: str) -> list[ContactEvent]:
        """Events that make a contact of a thing with the world."""
        return [
            event
            for event in self.contacts.events
            if event.change == "make" and event.pair.kind == "thing-world" and event.pair.first.entity == name
        ]

    def _released(self, made: ContactEvent) -> float:
        """When a contact that is made is broken again [s]; infinite if it never is."""
        times = [
            event.time
            for event in self.contacts.events
            if event.change == "break" and event.pair == made.pair and event.time > made.time
        ]
        return min(times, default=np.inf)

    def _frame(self, time: float) -> int:
        return min(round((time - LEAD_IN_TIME) * self.handled.rate), self.count - 1)

    def _rising(self, time: float) -> Array:
        """Shares (T,) that rise to 1 up to a time, within the reaching time."""
        return minimum_jerk((self.times - time) / self.reaching + 1.0)

    def _falling(self, time: float) -> Array:
        """Shares (T,) that fall from 1 at a time to 0, within the reaching time."""
        return 1.0 - minimum_jerk((self.times - time) / self.reaching)


def named_surfaces(system: System, palms: Mapping[str, str]) -> Iterator[tuple[SurfaceName, Surface]]:
    """Surfaces of a system under the names that events have for them."""
    for name, surface in system.surfaces.items():
        thing, _, face = name.partition("/")
        if not face:
            yield SurfaceName(WORLD if name == "floor" else ROBOT, name), surface
        elif surface.point is not None:
            yield SurfaceName(thing, face), surface
        elif face == "top":
            yield SurfaceName(WORLD, thing), surface
    for link, name in palms.items():
        yield SurfaceName(ROBOT, link), system.surface(name)


def _extent(system: System, name: str) -> tuple[Array, Array]:
    """Least and greatest coordinates (3,) of a thing's surfaces in its own axes [m]."""
    corners = np.vstack([surface.corners_at_point for surface in system.thing(name).surfaces.values()])
    return corners.min(axis=0), corners.max(axis=0)


def _interpolated(times: Array, known: Array, values: Array) -> Array:
    """Values (T, n) that go with least jerk from one known value to the next, and are constant before and after."""
    out = np.tile(values[0], (len(times), 1))
    for k in range(len(known) - 1):
        share = minimum_jerk((times - known[k]) / (known[k + 1] - known[k]))
        out += share[:, None] * (values[k + 1] - values[k])
    return out
