"""A robot as a tree of links with numbers only, whatever file it was read from, and the MuJoCo model of that tree."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import mujoco
import numpy as np
import pinocchio as pin

from sot.robots.reading.solid import Solid

Array = np.ndarray

FREE_JOINT = "root"
RESERVED_NAMES = frozenset({"world", "floor", "robot"})


@dataclass(frozen=True, eq=False)
class Hinge:
    """A joint that turns a link about an axis.

    Attributes:
        name: of the joint.
        anchor: a point of its axis in the link (3,) [m].
        axis: unit vector in the link (3,).
        reference: angle at which the link is where its placement says [rad].
        lower, upper: range [rad], infinite where nothing limits it.
        armature, damping, friction: reflected inertia [kg m²], viscous [N m s/rad] and Coulomb [N m] losses.
        velocity, effort: limits of the motor [rad/s, N m], infinite where the file gives none.
    """

    name: str
    anchor: Array
    axis: Array
    reference: float = 0.0
    lower: float = -np.inf
    upper: float = np.inf
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    velocity: float = np.inf
    effort: float = np.inf

    def moved(self, placement: pin.SE3) -> "Hinge":
        """The same joint for a link whose frame has been changed, given the place of the old frame in the new one."""
        return replace(self, anchor=placement.act(self.anchor), axis=placement.rotation @ self.axis)

    def turn(self, angle: float) -> pin.SE3:
        """The link's motion, in the link's own frame, to an angle [rad]."""
        rotation = pin.AngleAxis(angle - self.reference, self.axis).toRotationMatrix()
        return pin.SE3(rotation, self.anchor - rotation @ self.anchor)


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body of the tree: the base first, every parent before its children.

    Attributes:
        name: of the body.
        parent: index of the link that carries it, -1 for the base.
        placement: of its frame in the parent's, every joint at its reference; of the base none.
        joints: the hinges between parent and link, in the order in which they turn it; none for one that is fixed.
        inertia: mass, centre of mass and inertia in the link.
        solids, looks: what collides, and what is only seen.
        sites: named frames in the link.
    """

    name: str
    parent: int
    placement: pin.SE3 = field(repr=False)
    joints: tuple[Hinge, ...]
    inertia: pin.Inertia = field(repr=False)
    solids: tuple[Solid, ...] = field(default=(), repr=False)
    looks: tuple[Solid, ...] = field(default=(), repr=False)
    sites: tuple[tuple[str, pin.SE3], ...] = field(default=(), repr=False)


@dataclass(frozen=True, eq=False)
class Tree:
    """A robot.

    Attributes:
        name: of the model.
        links: the base first, every parent before its children.
        excluded: pairs of names of links that the file excludes from collisions.
        pairs: pairs of names of solids that may collide with one another; no others do.
    """

    name: str
    links: tuple[Link, ...]
    excluded: frozenset[frozenset[str]] = frozenset()
    pairs: tuple[tuple[str, str], ...] = ()

    @property
    def hinges(self) -> Iterator[Hinge]:
        """All joints, in the order in which MuJoCo and Pinocchio number them."""
        return (hinge for link in self.links for hinge in link.joints)

    @cached_property
    def owners(self) -> tuple[int, ...]:
        """The link that each link moves with: itself if it has joints, else the nearest before it that has; or 0."""
        owners: list[int] = []
        for k, link in enumerate(self.links):
            owners.append(k if link.joints or link.parent < 0 else owners[link.parent])
        return tuple(owners)

    def changed(self, change: Callable[[int, Link], Link]) -> "Tree":
        """The same tree, each link changed by a function of its index and itself."""
        return replace(self, links=tuple(change(k, link) for k, link in enumerate(self.links)))

    def with_hinges(self, change: Callable[[Hinge], Hinge]) -> "Tree":
        """The same tree, each joint changed by a function."""
        return self.changed(lambda _, link: replace(link, joints=tuple(change(hinge) for hinge in link.joints)))

    def with_base_turned(self, rotation: Array) -> "Tree":
        """The same robot, the frame of its base turned: `rotation` takes the old base's axes to the new one's."""
        turn = pin.SE3(rotation, np.zeros(3))

        def change(k: int, link: Link) -> Link:
            if link.parent == 0:
                return replace(link, placement=turn * link.placement)
            return moved_contents(link, turn) if k == 0 else link

        return self.changed(change)

    def spec(self) -> mujoco.MjSpec:
        """The tree for MuJoCo: the robot alone, on a free base, without motors or sensors."""
        spec = mujoco.MjSpec()
        spec.modelname = self.name
        spec.compiler.degree = False
        spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
        bodies: list[mujoco.MjsBody] = []
        for link in self.links:
            body = (spec.worldbody if link.parent < 0 else bodies[link.parent]).add_body(name=link.name)
            bodies.append(body)
            body.pos, body.quat = _position_and_quaternion(link.placement)
            _set_inertia(body, link.inertia)
            if link.parent < 0:
                body.add_freejoint(name=FREE_JOINT)
            for hinge in link.joints:
                _add_hinge(body, hinge)
            for solids, visible in ((link.looks, True), (link.solids, False)):
                for solid in solids:
                    solid.add_to(spec, body, visible)
            for name, placement in link.sites:
                position, quaternion = _position_and_quaternion(placement)
                body.add_site(name=name, pos=position, quat=quaternion, group=4)
        for first, second in self.pairs:
            spec.add_pair(geomname1=first, geomname2=second)
        return spec


def moved_contents(link: Link, placement: pin.SE3) -> Link:
    """A link whose frame has been changed, given the place of the old frame in the new one; its placement is kept."""
    return replace(
        link,
        joints=tuple(hinge.moved(placement) for hinge in link.joints),
        inertia=placement.act(link.inertia),
        solids=tuple(solid.moved(placement) for solid in link.solids),
        looks=tuple(solid.moved(placement) for solid in link.looks),
        sites=tuple((name, placement * site) for name, site in link.sites),
    )


def unique_name(wanted: str, taken: Iterable[str]) -> str:
    """The name, numbered if it is taken or reserved for the scene."""
    used = RESERVED_NAMES.union(taken)
    name, number = wanted, 1
    while name in used or not name:
        name, number = f"{wanted}_{number}", number + 1
    return name


def _add_hinge(body: mujoco.MjsBody, hinge: Hinge) -> None:
    joint = body.add_joint(name=hinge.name, type=mujoco.mjtJoint.mjJNT_HINGE, pos=hinge.anchor, axis=hinge.axis)
    joint.ref, joint.armature = hinge.reference, hinge.armature
    joint.damping[0], joint.frictionloss = hinge.damping, hinge.friction
    limited = bool(np.isfinite([hinge.lower, hinge.upper]).all())
    joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE if limited else mujoco.mjtLimited.mjLIMITED_FALSE
    if limited:
        joint.range = [hinge.lower, hinge.upper]


def _set_inertia(body: mujoco.MjsBody, inertia: pin.Inertia) -> None:
    if not inertia.mass > 0.0:
        return
    body.explicitinertial = True
    body.mass, body.ipos = inertia.mass, inertia.lever
    turning = inertia.inertia
    if np.count_nonzero(turning - np.diag(np.diagonal(turning))):
        body.fullinertia = [*np.diagonal(turning), turning[0, 1], turning[0, 2], turning[1, 2]]
    else:
        body.iquat, body.inertia = [1.0, 0.0, 0.0, 0.0], np.diagonal(turning)


def _position_and_quaternion(placement: pin.SE3) -> tuple[Array, list[float]]:
    """Position (3,) and quaternion wxyz."""
    x, y, z, w = pin.Quaternion(placement.rotation).coeffs()
    return placement.translation, [w, x, y, z]
