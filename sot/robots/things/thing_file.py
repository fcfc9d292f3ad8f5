"""The text file of a thing, and its MJCF as MuJoCo's specification, with what a user overrides when loading it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from sot.errors import InputError
from sot.robots.reading.mjcf_file import mjcf_spec
from sot.robots.surface import Surface
from sot.robots.surface_table import MAX_FRICTION, read_surfaces
from sot.toml_file import is_number, nearest, read_toml

Array = np.ndarray

KEYS = ("label", "model", "body", "size", "surfaces")


class ThingFile:
    """The text file of a thing.

    Args:
        path: of the file.
        size: full sides of the thing (3,) [m] in the place of the file's `size`, by which the model is scaled; the
            model of a thing that has a size is a cube of 1 m.

    Attributes:
        label: what a reader should call it.
        body: name of the body whose frame is the thing's; None for the first that moves, or the first.

    Raises:
        InputError: it cannot be read, has an unknown key, or a size that is none.
    """

    def __init__(self, path: Path, size: Sequence[float] | None = None) -> None:
        self.path = path
        content = read_toml(path, "a thing file")
        for key in content:
            if key not in KEYS:
                raise self.error(f"no thing file has '{key}'{nearest(key, KEYS)}: {', '.join(KEYS)}")
        self.label = self._text(content, "label")
        self.body = self._text(content, "body") if "body" in content else None
        self._model = path.parent / self._text(content, "model")
        if not self._model.is_file():
            raise self.error(f"no model file '{self._model.name}' beside it")
        if size is not None and "size" not in content:
            raise self.error("the thing has no size that could be changed")
        self.scale = np.ones(3) if "size" not in content else self._size(content["size"] if size is None else size)
        self._surfaces = content.get("surfaces", {})

    def error(self, message: str) -> InputError:
        """An error that says where it is."""
        return InputError(f"{self.path}: {message}")

    def surfaces(self, points: Sequence[str], body: str) -> dict[str, Surface]:
        """Surfaces by name, scaled, in the frames of points, of `body` unless they say so.

        Raises:
            InputError: a surface names no point, or its corners make none.
        """
        surfaces = read_surfaces(self.path, self._surfaces, points, body)
        return {
            name: Surface.of_corners(name, surface.corners_at_point * self.scale, surface.point, surface.friction)
            for name, surface in surfaces.items()
        }

    def spec(
        self,
        mass: float | None = None,
        friction: float | None = None,
        stiffness: float | None = None,
        damping: float | None = None,
    ) -> mujoco.MjSpec:
        """The thing alone for MuJoCo, a new one each time.

        Args:
            mass: of the whole thing [kg].
            friction: of its shapes.
            stiffness, damping: of all its joints that turn or slide [N m/rad, N m s/rad].

        Raises:
            InputError: MuJoCo cannot read it, something without mass moves, or a value makes no sense.
        """
        for name, value, least, most in (
            ("mass", mass, 1e-6, np.inf),
            ("friction", friction, 1e-6, MAX_FRICTION),
            ("stiffness", stiffness, 0.0, np.inf),
            ("damping", damping, 0.0, np.inf),
        ):
            if value is not None and not (is_number(value) and least <= value <= most):
                raise self.error(f"{name} = {value}: give a number above 0" + (", at most 1" if most < 2.0 else ""))
        try:
            spec = mjcf_spec(self._model)
            _scale(spec, self.scale)
            compiled = spec.copy().compile()
        except (ValueError, mujoco.FatalError) as error:
            if "moving bodies must be larger" in str(error):
                raise self.error("a body of the thing moves and has no mass: give it one in its model") from None
            raise self.error(f"MuJoCo cannot read {self._model.name}: {' '.join(str(error).split())}") from None
        if mass is not None:
            _scale_mass(spec, mass / float(compiled.body_mass.sum()))
        if friction is not None:
            for geom in spec.geoms:
                geom.friction[0] = friction
        for joint in spec.joints:
            if joint.type in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
                if stiffness is not None:
                    joint.stiffness[0] = stiffness
                if damping is not None:
                    joint.damping[0] = damping
        return spec

    def _text(self, content: dict[str, Any], key: str) -> str:
        if not isinstance(content.get(key), str):
            raise self.error(f"'{key}' is missing, or no text")
        return str(content[key])

    def _size(self, size: Any) -> Array:
        sides = list(size) if isinstance(size, list | tuple | np.ndarray) else []
        if len(sides) != 3 or not all(is_number(float(side)) and side > 0.0 for side in sides):
            raise self.error(f"size must be three sides above 0 [m], not {size}")
        return np.array(sides, dtype=float)


def _scale(spec: mujoco.MjSpec, scale: Array) -> None:
    """Scale a thing along the axes of its bodies, its masses kept; shapes other than boxes need equal factors."""
    if np.array_equal(scale, np.ones(3)):
        return
    for geom in spec.geoms:
        if geom.type != mujoco.mjtGeom.mjGEOM_BOX and np.ptp(scale):
            raise ValueError(f"geom '{geom.name}' is no box and cannot be scaled by different factors")
        geom.size[:] = geom.size * scale
        geom.pos[:] = geom.pos * scale
    for part in (*spec.sites, *spec.joints, *spec.bodies):
        part.pos[:] = part.pos * scale


def _scale_mass(spec: mujoco.MjSpec, factor: float) -> None:
    for geom in spec.geoms:
        geom.mass, geom.density = geom.mass * factor, geom.density * factor
    for body in spec.bodies:
        if body.explicitinertial:
            body.mass, body.inertia, body.fullinertia = (
                body.mass * factor,
                body.inertia * factor,
                body.fullinertia * factor,
            )
