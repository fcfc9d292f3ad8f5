"""Surfaces: flat patches of robots, of things and of the world around them, which contacts pair."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sot.errors import InputError

Array = np.ndarray

FLATNESS_TOLERANCE = 1e-3
"""Distance [m] by which the corners of a surface may be off their plane."""
LEVEL_TOLERANCE = 1e-6
"""Tilt [rad] below which a surface is level."""
PAD_THICKNESS = 0.01
"""Thickness of the box that is a surface's shape where its body has none there [m]."""
INWARD = np.diag([1.0, -1.0, -1.0])
"""Turns axes whose z points out of a body into axes whose z points into it, and back."""


class SurfaceAxes(NamedTuple):
    """Origin (3,) of a surface and its axes (3, 3), z out of its body, in a frame or in the world."""

    translation: Array
    rotation: Array


@dataclass(frozen=True, eq=False)
class Surface:
    """A flat patch of a body, or of the world.

    Attributes:
        name: what contacts, events and recordings call it; a thing's are called "thing/surface".
        corners: (n, 3) in the surface's own axes, whose z points out of the body [m].
        placement: of these axes in the frame of `point`, or in the world.
        point: the operational point of a robot or of a thing that it is fixed to; None for the world.
        friction: Coulomb coefficient that may be relied upon at it.
    """

    name: str
    corners: Array = field(repr=False)
    placement: pin.SE3 = field(default_factory=pin.SE3.Identity, repr=False)
    point: str | None = None
    friction: float = 0.5

    @staticmethod
    def of_corners(
        name: str, corners: Sequence[Sequence[float]] | Array, point: str | None = None, friction: float = 0.5
    ) -> "Surface":
        """The surface between corners (n, 3) in the frame of a point, or in the world unless one is given [m].

        Seen from outside of the body the corners go round counter-clockwise. The surface's origin is in their middle,
        its x axis along the first edge.

        Raises:
            InputError: fewer than three corners, or corners that are not in one plane.
        """
        try:
            at = np.array(corners, dtype=float)
        except (TypeError, ValueError):
            at = np.empty(0)
        if at.ndim != 2 or at.shape[1] != 3 or len(at) < 3 or not np.isfinite(at).all():
            raise InputError(f"surface '{name}': give three corners or more, each of three numbers [m]")
        middle, edges = at.mean(axis=0), np.roll(at, -1, axis=0) - at
        normal: Array = np.cross(edges, np.roll(edges, -1, axis=0)).sum(axis=0)
        x, z = edges[0] / max(np.linalg.norm(edges[0]), 1e-12), normal / max(np.linalg.norm(normal), 1e-12)
        if np.linalg.norm(x) < 0.5 or np.linalg.norm(z) < 0.5 or np.abs((at - middle) @ z).max() > FLATNESS_TOLERANCE:
            raise InputError(f"surface '{name}': its corners are not in one plane, or not in order around it")
        x -= (x @ z) * z
        x /= np.linalg.norm(x)
        placement = pin.SE3(np.column_stack([x, np.cross(z, x), z]), middle)
        return Surface(name, (at - middle) @ placement.rotation, placement, point, friction)

    @staticmethod
    def of_sole(foot: str, corners: Array, friction: float = 0.5) -> "Surface":
        """The sole between corners (n, 3) of a foot's frame, whose z points into the foot and whose origin it keeps."""
        return Surface(foot, corners @ INWARD, pin.SE3(INWARD, np.zeros(3)), foot, friction)

    @cached_property
    def axes(self) -> SurfaceAxes:
        """Its placement as arrays, which are quicker to read."""
        return SurfaceAxes(self.placement.translation.copy(), np.ascontiguousarray(self.placement.rotation))

    @cached_property
    def tilt(self) -> Array:
        """The least turn (3,) that lays what is level in the world flat against it, as a rotation vector [rad]."""
        aside, up = self.axes.rotation[:2, 2], self.axes.rotation[2, 2]
        sine = float(np.hypot(*aside))
        if sine < LEVEL_TOLERANCE:
            return np.zeros(3)
        tilt: Array = np.arctan2(sine, up) / sine * np.array([-aside[1], aside[0], 0.0])
        return tilt

    @property
    def owner(self) -> str:
        """What it belongs to: a thing, "floor", or itself for one of a robot or of the world."""
        return self.name.split("/", 1)[0]

    @property
    def corners_at_point(self) -> Array:
        """Its corners (n, 3) in the frame of its point, or in the world [m]."""
        return self.corners @ self.placement.rotation.T + self.placement.translation

    def height_at(self, places: Array) -> Array:
        """Height (...,) of its plane at horizontal places (..., 2) of the frame that it is placed in [m]."""
        origin, normal = self.axes.translation, self.axes.rotation[:, 2]
        height: Array = origin[2] - (places - origin[:2]) @ normal[:2] / normal[2]
        return height

    def edge_margins(self, points: Array) -> Array:
        """Distances (...,) of points (..., 3) of its plane from its nearest edge [m], negative beyond it, inf without.

        The points are in the frame that it is placed in; its corners are those of a convex patch.
        """
        corners = self.corners[:, :2]
        if not len(corners):
            return np.full(points.shape[:-1], np.inf)
        local = ((points - self.axes.translation) @ self.axes.rotation)[..., :2]
        edges = np.roll(corners, -1, axis=0) - corners
        inward = np.column_stack([-edges[:, 1], edges[:, 0]]) / np.linalg.norm(edges, axis=1, keepdims=True)
        margins: Array = np.einsum("...nj,nj->...n", local[..., None, :] - corners, inward).min(axis=-1)
        return margins

    def pad(self) -> tuple[Array, pin.SE3]:
        """Half sides (3,) of a thin box behind the surface, and its place in the frame of the point [m]."""
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        half, middle = 0.5 * (high - low), 0.5 * (low + high)
        half[2], middle[2] = 0.5 * PAD_THICKNESS, -0.5 * PAD_THICKNESS
        return half, self.placement * pin.SE3(np.eye(3), middle)


FLOOR = Surface("floor", np.zeros((0, 3)))
"""The floor at z = 0, of any size; what a sole may rely on is a matter of the sole's friction."""


def named_surface(surfaces: Mapping[str, Surface], name: str, there_is: str) -> Surface:
    """The surface of a name among others.

    Raises:
        InputError: There is none; the message begins with `there_is`.
    """
    try:
        return surfaces[name]
    except KeyError:
        raise InputError(f"{there_is} no surface '{name}': choose one of {', '.join(surfaces)}") from None
