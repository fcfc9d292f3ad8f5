"""What a user adds to the world: a table, a ball, a wall."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable

import mujoco

from sot.errors import InputError

Scene = Callable[[mujoco.MjSpec], object] | str
"""A function that changes the specification of robot and floor, or a whole MJCF document as text."""

PREFIX = "scene/"
"""Of the names in MJCF text, so that none is the robot's as well."""
ALL_COLLISION_BITS = 0x7FFFFFFF
_NOT_ADDED = ("option", "size", "visual", "statistic", "keyframe")
"""Parts of MJCF text that are left out: the world has its own."""


def add_scene(spec: mujoco.MjSpec, scene: Scene) -> None:
    """Add a scene to the robot on its floor. What may collide at all in it may collide with anything.

    MuJoCo's collision bits of the robot tell its limbs apart; a geom whose bits are both 0 is for the eye only.

    Args:
        spec: Of the robot and the floor; changed.
        scene: What to add.

    Raises:
        InputError: MuJoCo cannot read the text.
    """
    before = list(spec.geoms)
    if callable(scene):
        scene(spec)
    else:
        try:
            added = mujoco.MjSpec.from_string(_document(scene))
            spec.attach(added, frame=spec.worldbody.add_frame(), prefix=PREFIX)
        except (ValueError, ElementTree.ParseError) as error:
            raise InputError(f"scene: MuJoCo cannot read it: {' '.join(str(error).split())}") from None
    for geom in spec.geoms:
        if (geom.contype or geom.conaffinity) and not any(geom is other for other in before):
            geom.conaffinity = ALL_COLLISION_BITS


def _document(text: str) -> str:
    """The document without what the world has already."""
    root = ElementTree.fromstring(text.strip())
    for part in [child for child in root if child.tag in _NOT_ADDED]:
        root.remove(part)
    return ElementTree.tostring(root, encoding="unicode")
