"""What a human handles in a demonstration: the paths of its objects, and the level surfaces around."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from sot.errors import InputError
from sot.toml_file import read_toml
from sot.whole_file import atomic_write

Array = NDArray[np.float64]

FACES: dict[str, tuple[int, float]] = {
    "front": (0, -1.0),
    "back": (0, 1.0),
    "left": (1, 1.0),
    "right": (1, -1.0),
    "top": (2, 1.0),
    "bottom": (2, -1.0),
}
"""Name of each face of a box, as who stands before it and looks along X sees it -> axis of its outward normal, sign."""
HEAD = """\
# The objects of a demonstration, in the clip's world: metres, Z up, the human's first frame over the origin, facing X.
# level: surfaces of the world, each with its centre and its size along X and Y.
# object: size of the box that it is, along its own axes; hinged, whether it turns on a hinge, as a door does; path,
# a line a frame: x, y, z of its centre and its quaternion (x, y, z, w).
"""


@dataclass(frozen=True)
class ObjectPath:
    """Where a box-shaped object is over time.

    Attributes:
        size: Along its own axes (3,) [m].
        position: Of its centre, world (T, 3) [m].
        rotation: From object to world (T, 3, 3).
        hinged: Whether it turns on a hinge, and so lies on nothing.
    """

    size: Array
    position: Array
    rotation: Array
    hinged: bool = False

    def local(self, points: Array) -> Array:
        """Points (T, 3) of the world in the object's axes, from its centre [m]."""
        inside: Array = np.einsum("tji,tj->ti", self.rotation, points - self.position)
        return inside


@dataclass(frozen=True)
class LevelSurface:
    """A level rectangle of the world that things lie on: centre (3,) and size along X and Y (2,) [m]."""

    centre: Array
    size: Array


@dataclass(frozen=True)
class HandledObjects:
    """The objects of a demonstration and the surfaces around.

    Attributes:
        rate: Frames per second [Hz].
        objects: Paths by the objects' names.
        surfaces: Of the world, by name; the floor is not among them.
    """

    rate: float
    objects: Mapping[str, ObjectPath]
    surfaces: Mapping[str, LevelSurface]

    def resampled_at(self, times: Array) -> "HandledObjects":
        """The objects where they are at times (T,) within their paths [s], which become frames at the same rate."""

        def sampled(path: ObjectPath) -> ObjectPath:
            known = np.arange(len(path.position)) / self.rate
            inside = np.minimum(times, known[-1])
            rotation = Slerp(known, Rotation.from_matrix(path.rotation))(inside).as_matrix()
            return replace(path, position=CubicSpline(known, path.position)(inside), rotation=rotation)

        return replace(self, objects={name: sampled(path) for name, path in self.objects.items()})


def write_objects(path: Path, handled: HandledObjects) -> None:
    """Write the objects of a demonstration to a file (`.toml`), which appears once it is complete."""
    blocks = [HEAD, f"rate = {handled.rate:g}  # Hz\n"]
    for name, surface in handled.surfaces.items():
        blocks.append(f"\n[level.{name}]\ncentre = {_text(surface.centre)}\nsize = {_text(surface.size)}\n")
    for name, one in handled.objects.items():
        rows = np.hstack([one.position, Rotation.from_matrix(one.rotation).as_quat()])
        lines = "".join(f"  {_text(row)},\n" for row in rows)
        hinged = "true" if one.hinged else "false"
        blocks.append(f"\n[object.{name}]\nsize = {_text(one.size)}\nhinged = {hinged}\npath = [\n{lines}]\n")
    with atomic_write(path) as place:
        place.write_text("".join(blocks), encoding="utf-8")


def read_objects(path: Path) -> HandledObjects:
    """The objects of a file that `write_objects` wrote.

    Raises:
        InputError: Not such a file.
    """
    content = read_toml(path, "a file of a demonstration's objects")
    if not set(content) <= {"rate", "level", "object"} or not content.get("object"):
        raise InputError(f"{path}: needs a rate, [object.NAME] tables, and [level.NAME] tables if things lie on any")
    rate: Any = content.get("rate")
    if not isinstance(rate, int | float) or isinstance(rate, bool) or not 0.0 < rate < math.inf:
        raise InputError(f"{path}: rate must be frames per second, not {rate!r}")
    surfaces = {
        name: LevelSurface(
            _numbers(f"{path}: level {name}", entry, "centre", (3,)),
            _numbers(f"{path}: level {name}", entry, "size", (2,)),
        )
        for name, entry in _tables(path, content, "level").items()
    }
    objects = {}
    for name, entry in _tables(path, content, "object").items():
        where = f"{path}: object {name}"
        rows, size = _numbers(where, entry, "path", (None, 7)), _numbers(where, entry, "size", (3,))
        lengths = np.linalg.norm(rows[:, 3:], axis=1)
        if size.min() <= 0.0 or np.abs(lengths - 1.0).max() > 1e-2:
            raise InputError(f"{where}: sizes must be positive, and quaternions of length 1")
        if not isinstance(entry.get("hinged", False), bool):
            raise InputError(f"{where}: hinged must be true or false")
        rotation = Rotation.from_quat(rows[:, 3:]).as_matrix()
        objects[name] = ObjectPath(size, rows[:, :3], rotation, entry.get("hinged", False))
    if len({len(one.position) for one in objects.values()}) > 1:
        raise InputError(f"{path}: the paths of its objects differ in length")
    return HandledObjects(float(rate), objects, surfaces)


def _tables(path: Path, content: Mapping[str, Any], kind: str) -> Mapping[str, Mapping[str, Any]]:
    entries = content.get(kind, {})
    if not isinstance(entries, dict) or not all(isinstance(entry, dict) for entry in entries.values()):
        raise InputError(f"{path}: {kind} must be tables [{kind}.NAME]")
    return entries


def _numbers(where: str, entry: Mapping[str, Any], key: str, shape: Sequence[int | None]) -> Array:
    """An array of a file, of a shape in which None stands for any length."""
    try:
        values = np.array(entry.get(key), dtype=float)
    except (TypeError, ValueError):
        values = np.zeros(0)
    fits = values.ndim == len(shape) and all(n is None or n == m for n, m in zip(shape, values.shape, strict=True))
    if not fits or not values.size or not np.isfinite(values).all():
        raise InputError(f"{where}: {key} must be numbers, {' x '.join('N' if n is None else str(n) for n in shape)}")
    return values


def _text(values: Array) -> str:
    return "[" + ", ".join(f"{value + 0.0:.4f}" for value in np.round(values, 4)) + "]"
