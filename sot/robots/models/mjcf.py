"""A robot as a tree of links, and the MJCF text of it, kept to what MuJoCo and Pinocchio read alike.

All link frames are parallel at zero configuration and every joint is a hinge at its link's origin, so a body
needs a position and no rotation. Masses are always written out: neither reader has to infer them from shapes.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

Vector = tuple[float, float, float]

AXES = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


@dataclass(frozen=True)
class MassProperties:
    """Mass [kg], centre of mass [m] (3,) in the link frame, and inertia [kg m²] (3, 3) about the centre of mass."""

    mass: float
    com: np.ndarray
    inertia: np.ndarray

    @classmethod
    def diagonal(cls, mass: float, com: Vector, inertia: Vector) -> "MassProperties":
        return cls(mass, np.array(com), np.diag(inertia))

    def _about_origin(self) -> np.ndarray:
        return self.inertia + self.mass * (self.com @ self.com * np.eye(3) - np.outer(self.com, self.com))

    def _combined(self, other: "MassProperties", sign: float) -> "MassProperties":
        mass = self.mass + sign * other.mass
        com = (self.mass * self.com + sign * other.mass * other.com) / mass
        about_origin = self._about_origin() + sign * other._about_origin()
        inertia = about_origin - mass * (com @ com * np.eye(3) - np.outer(com, com))
        return MassProperties(mass, com, inertia)

    def __add__(self, other: "MassProperties") -> "MassProperties":
        """Both bodies held together; the two are given in one frame."""
        return self._combined(other, 1.0)

    def __sub__(self, other: "MassProperties") -> "MassProperties":
        """What is left when `other` is cut out."""
        return self._combined(other, -1.0)

    def mirrored(self) -> "MassProperties":
        flip = np.diag([1.0, -1.0, 1.0])
        return MassProperties(self.mass, flip @ self.com, flip @ self.inertia @ flip)


@dataclass(frozen=True)
class Shape:
    """A primitive geom: `at` is its centre, or with `to` the first end of a capsule or cylinder [m]."""

    kind: str
    size: tuple[float, ...]
    at: Vector
    to: Vector | None = None
    look: str = ""
    tilt: float = 0.0  # rotation about the y axis [rad], for shells that lean forward

    def mirrored(self) -> "Shape":
        return replace(self, at=mirror(self.at), to=mirror(self.to) if self.to else None)


@dataclass(frozen=True)
class Joint:
    """A hinge: axis letter, range [rad], torque limit [N m], gear ratio, armature [kg m²], and its losses."""

    name: str
    axis: str
    lower: float
    upper: float
    torque: float
    gear_ratio: float
    armature: float
    losses: str

    def mirrored(self, name: str) -> "Joint":
        if self.axis == "y":
            return replace(self, name=name)
        return replace(self, name=name, lower=-self.upper, upper=-self.lower)


@dataclass(frozen=True)
class Link:
    """A body, the hinge that carries it (none: the free base), what it looks like and what it collides with.

    `contact` is the bit of its collision shapes and `collides` the bits they meet, as MuJoCo's contype and
    conaffinity. `sites` are named points in the link frame [m].
    """

    name: str
    parent: str | None
    offset: Vector
    body: MassProperties
    joint: Joint | None = None
    shapes: tuple[Shape, ...] = ()
    collision: tuple[Shape, ...] = ()
    contact: int = 0
    collides: int = 0
    sites: dict[str, Vector] = field(default_factory=dict)


def mirror(v: Vector) -> Vector:
    """The vector seen in the sagittal mirror (y changes sign; 0 stays a plain 0)."""
    return (v[0], 0.0 - v[1], v[2])


def number_text(values: float | Iterable[float]) -> str:
    """Numbers as MJCF writes them, to 10 significant digits."""
    if isinstance(values, int | float):
        values = (values,)
    return " ".join(f"{round(float(v), 12) + 0.0:.10g}" for v in values)


def _add_geom(parent: ET.Element, shape: Shape, **attributes: str) -> None:
    geom = ET.SubElement(parent, "geom", attributes | {"type": shape.kind, "size": number_text(shape.size)})
    if shape.to is None:
        geom.set("pos", number_text(shape.at))
    else:
        geom.set("fromto", number_text((*shape.at, *shape.to)))
    if shape.tilt:
        geom.set("quat", number_text((np.cos(shape.tilt / 2), 0.0, np.sin(shape.tilt / 2), 0.0)))
    if shape.look:
        geom.set("material", shape.look)


def _add_body(parent: ET.Element, link: Link) -> ET.Element:
    body = ET.SubElement(parent, "body", name=link.name, pos=number_text(link.offset))
    if link.joint is None:
        ET.SubElement(body, "freejoint", name="root")
    else:
        j = link.joint
        ET.SubElement(
            body,
            "joint",
            {"class": j.losses},
            name=j.name,
            axis=AXES[j.axis],
            range=number_text((j.lower, j.upper)),
            armature=number_text(j.armature),
            actuatorfrcrange=number_text((-j.torque, j.torque)),
        )
    inertia = link.body.inertia
    ET.SubElement(
        body,
        "inertial",
        pos=number_text(link.body.com),
        mass=number_text(link.body.mass),
        fullinertia=number_text((*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])),
    )
    for shape in link.shapes:
        _add_geom(body, shape, **{"class": "visual"})
    for k, shape in enumerate(link.collision):
        bits = {"contype": str(link.contact), "conaffinity": str(link.collides)}
        _add_geom(body, shape, name=f"{link.name}_{k}", **{"class": "collision"}, **bits)
    for name, position in link.sites.items():
        ET.SubElement(body, "site", name=name, pos=number_text(position))
    return body


def mjcf_text(
    name: str,
    links: Sequence[Link],
    losses: dict[str, tuple[float, float]],
    looks: dict[str, Vector],
    key: tuple[str, Sequence[float]],
    note: str,
) -> str:
    """MJCF text of a robot.

    Args:
        name: model name.
        links: base first, every parent before its children, depth first in the order the joints shall have.
        losses: class name -> (viscous damping [N m s/rad], friction loss [N m]).
        looks: material name -> rgb.
        key: name and configuration of the rest posture, MuJoCo's order (position, quaternion wxyz, joints).
        note: the comment at the top of the file.
    """
    root = ET.Element("mujoco", model=name)
    root.append(ET.Comment(f" {note} "))
    ET.SubElement(root, "compiler", angle="radian")
    default = ET.SubElement(root, "default")
    for losses_name, (damping, friction) in losses.items():
        ET.SubElement(
            ET.SubElement(default, "default", {"class": losses_name}),
            "joint",
            damping=number_text(damping),
            frictionloss=number_text(friction),
        )
    visual = ET.SubElement(default, "default", {"class": "visual"})
    ET.SubElement(visual, "geom", contype="0", conaffinity="0", group="2")
    collision = ET.SubElement(default, "default", {"class": "collision"})
    ET.SubElement(collision, "geom", group="3", friction="0.7 0.005 0.0001", rgba="0.9 0.5 0.1 0.4")
    asset = ET.SubElement(root, "asset")
    for look, rgb in looks.items():
        ET.SubElement(asset, "material", name=look, rgba=number_text((*rgb, 1.0)))
    bodies: dict[str | None, ET.Element] = {None: ET.SubElement(root, "worldbody")}
    for link in links:
        bodies[link.name] = _add_body(bodies[link.parent], link)
    actuator = ET.SubElement(root, "actuator")
    for joint in (link.joint for link in links if link.joint):
        limit = number_text((-joint.torque, joint.torque))
        ET.SubElement(actuator, "motor", name=joint.name, joint=joint.name, ctrlrange=limit)
    keyframe = ET.SubElement(root, "keyframe")
    ET.SubElement(keyframe, "key", name=key[0], qpos=number_text(key[1]))
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"
