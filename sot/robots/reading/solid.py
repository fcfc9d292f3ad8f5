"""Shapes of links: primitives and convex hulls, and those that are fitted about meshes."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import coal
import mujoco
import numpy as np
import pinocchio as pin
from scipy.spatial import ConvexHull, QhullError

Array = np.ndarray

CAPSULE_MIN_ROUNDNESS = 0.6  # least ratio of a long mesh's two other sides that makes it a capsule rather than a box
CAPSULE_MIN_SLENDERNESS = 1.3  # least ratio of a capsule's length to its thickness
FIT_TOLERANCE = 0.01  # m, how far from its mesh the surface of a primitive may be
FIT_TOLERANCE_RATIO = 0.05  # the same, of the longest side of the mesh
HULL_TOLERANCE = 0.003  # m, how far a hull of few vertices may lie inside the whole hull
HULL_TOLERANCE_RATIO = 0.01  # the same, of the longest side of the mesh
HULL_MAX_VERTICES = 60
MIN_SIDE = 1e-4  # m, thinnest side of a fitted box or hull
VISUAL_GROUP, COLLISION_GROUP = 2, 3  # MuJoCo's viewers show the groups 0 to 2

GEOMS = {
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "hull": mujoco.mjtGeom.mjGEOM_MESH,
}


@dataclass(frozen=True, eq=False)
class Solid:
    """A convex shape fixed to a link.

    Attributes:
        name: its own name, empty for one that is only seen.
        kind: sphere, capsule, cylinder, ellipsoid, box or hull; capsules and cylinders lie along their z axis.
        size: MuJoCo's numbers: radius (and half length), semi-axes or half sides [m] (3,); unused by a hull.
        placement: in the link.
        vertices: corners of a hull in its own frame (n, 3) [m]; None for a primitive.
        meshes: corners of the hull of the meshes that it stands for, likewise; None if there are none.
        friction: sliding friction coefficient, of what collides.
        contype, conaffinity: MuJoCo's bits: two solids may collide if one's type meets the other's affinity.
        rgba: colour, 0..1.
    """

    name: str
    kind: str
    size: Array = field(repr=False)
    placement: pin.SE3 = field(repr=False)
    vertices: Array | None = field(default=None, repr=False)
    friction: float = 1.0
    contype: int = 1
    conaffinity: int = 1
    rgba: tuple[float, ...] = (0.5, 0.5, 0.5, 1.0)
    meshes: Array | None = field(default=None, repr=False)

    def moved(self, placement: pin.SE3) -> "Solid":
        """The same shape in another frame, given the place of its frame in that one."""
        return replace(self, placement=placement * self.placement)

    def coal(self) -> coal.ShapeBase:
        """The shape as the distance computations take it."""
        x, y, z = self.size.tolist()
        match self.kind:
            case "sphere":
                return coal.Sphere(x)
            case "capsule":
                return coal.Capsule(x, 2 * y)
            case "cylinder":
                return coal.Cylinder(x, 2 * y)
            case "ellipsoid":
                return coal.Ellipsoid(x, y, z)
            case "box":
                return coal.Box(2 * x, 2 * y, 2 * z)
        return _coal_hull(self.vertices)

    def add_to(self, spec: mujoco.MjSpec, body: mujoco.MjsBody, visible: bool) -> None:
        """Add the shape to a body: one that is only seen, or one that only collides."""
        x, y, z, w = pin.Quaternion(self.placement.rotation).coeffs()
        geom = body.add_geom(
            type=GEOMS[self.kind], size=self.size, pos=self.placement.translation, quat=[w, x, y, z], mass=0.0
        )
        geom.rgba = self.rgba
        if self.vertices is not None:
            mesh = f"hull_{len(spec.meshes)}"
            spec.add_mesh(
                name=mesh, uservert=self.vertices.ravel(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            )
            geom.meshname = mesh
        # The floor and things meet every shape; the robot's own shapes meet in the pairs of one list only.
        geom.contype, geom.conaffinity = (0, 0) if visible else (1, 0)
        geom.group = VISUAL_GROUP if visible else COLLISION_GROUP
        if not visible:
            geom.name, geom.friction[0] = self.name, self.friction

    def lowest_points(self, up: Array) -> Array:
        """Points of the surface (n, 3) in the link that may be lowest along a direction `up` of the link [m].

        Of a solid that stands for meshes, they are the meshes'.
        """
        if self.meshes is not None:
            return _acted(self.placement, self.meshes)
        direction = self.placement.rotation.T @ np.asarray(up)
        return _acted(self.placement, self._outline() - self._rounding(direction))

    def _outline(self) -> Array:
        x, y, z = self.size.tolist()
        match self.kind:
            case "sphere" | "ellipsoid":
                return np.zeros((1, 3))
            case "capsule":
                return np.array([[0.0, 0.0, -y], [0.0, 0.0, y]])
            case "cylinder":
                angles = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
                rim = np.column_stack([x * np.cos(angles), x * np.sin(angles), np.full(24, y)])
                return np.vstack([rim, rim * (1.0, 1.0, -1.0)])
            case "box":
                return np.array([(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        assert self.vertices is not None
        return self.vertices

    def _rounding(self, direction: Array) -> Array:
        """From a point of the outline to the surface along a unit direction of the shape (3,)."""
        if self.kind in ("sphere", "capsule"):
            return self.size[0] * direction
        if self.kind == "ellipsoid":
            scaled = self.size * direction
            return self.size * scaled / np.linalg.norm(scaled)
        return np.zeros(3)


def _spread_directions(count: int) -> Array:
    """Directions spread over the sphere, the six along the axes last (count + 6, 3)."""
    k = np.arange(count) + 0.5
    z, angle = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - z**2)
    return np.vstack([np.column_stack([ring * np.cos(angle), ring * np.sin(angle), z]), np.eye(3), -np.eye(3)])


DIRECTIONS = _spread_directions(300)
"""Along which shapes are compared."""


class Mesh(NamedTuple):
    """A mesh of a link.

    Attributes:
        vertices: in the link (n, 3) [m].
        axes: along which it was drawn (3, 3).
        rgba: colour, 0..1.
        friction, contype, conaffinity: as of a `Solid`.
    """

    vertices: Array
    axes: Array
    rgba: tuple[float, ...]
    friction: float = 1.0
    contype: int = 1
    conaffinity: int = 1

    def moved(self, placement: pin.SE3) -> "Mesh":
        """The same mesh in another frame, given the place of its frame in that one."""
        return self._replace(vertices=_acted(placement, self.vertices), axes=placement.rotation @ self.axes)


def fitted_primitive(meshes: Sequence[Mesh]) -> Solid:
    """A capsule about some meshes of one link if they are long and round, else a box; without a name, for looks."""
    capsule, box = _primitives("", meshes)
    longest = int(box.size.argmax())
    others = np.delete(box.size, longest)
    slender = box.size[longest] >= CAPSULE_MIN_SLENDERNESS * others.mean()
    return capsule if slender and others.min() >= CAPSULE_MIN_ROUNDNESS * others.max() else box


def fitted_solid(name: str, meshes: Sequence[Mesh]) -> Solid:
    """What a link collides with in the place of its meshes: a capsule or box if one fits, else their convex hull.

    A primitive fits if its surface is nowhere further than FIT_TOLERANCE, or FIT_TOLERANCE_RATIO of the longest side,
    from the meshes' hull. Of a hull with many corners a few are kept.
    """
    vertices = np.vstack([mesh.vertices for mesh in meshes])
    candidates = _primitives(name, meshes)
    try:
        hull = ConvexHull(vertices)
    except QhullError:  # flat: the box about it is as thin
        return candidates[-1]
    side, whole = float(np.ptp(vertices, axis=0).max()), vertices[hull.vertices]
    tolerance = min(FIT_TOLERANCE, FIT_TOLERANCE_RATIO * side)
    for primitive in candidates:
        if _misfit(primitive, whole) <= tolerance:
            return replace(primitive, meshes=_acted(primitive.placement.inverse(), whole))
    corners = _few_vertices(whole, hull.equations, min(HULL_TOLERANCE, HULL_TOLERANCE_RATIO * side))
    centre = corners.mean(axis=0)
    place = pin.SE3(np.eye(3), centre)
    return replace(candidates[-1], kind="hull", placement=place, vertices=corners - centre, meshes=whole - centre)


def _primitives(name: str, meshes: Sequence[Mesh]) -> tuple[Solid, Solid]:
    """A capsule and a box about meshes, along the axes, of the link or of one of the meshes, that make them least."""
    vertices = np.vstack([mesh.vertices for mesh in meshes])
    axes = [np.eye(3), *(mesh.axes for mesh in meshes)]
    turn = min(axes, key=lambda axes: np.prod(np.ptp(vertices @ axes, axis=0)))
    low, high = (vertices @ turn).min(axis=0), (vertices @ turn).max(axis=0)
    half, centre = np.maximum((high - low) / 2, MIN_SIDE / 2), turn @ (low + high) / 2
    box = Solid(
        name,
        "box",
        half,
        pin.SE3(turn, centre),
        friction=max(mesh.friction for mesh in meshes),
        contype=int(np.bitwise_or.reduce([mesh.contype for mesh in meshes])),
        conaffinity=int(np.bitwise_or.reduce([mesh.conaffinity for mesh in meshes])),
        rgba=meshes[0].rgba,
    )
    longest = int(half.argmax())
    radius = float(np.delete(half, longest).mean())
    along = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), turn[:, longest]).matrix()
    size = np.array([radius, max(float(half[longest]) - radius, MIN_SIDE), 0.0])
    return replace(box, kind="capsule", size=size, placement=pin.SE3(along, centre)), box


def _misfit(solid: Solid, corners: Array) -> float:
    """Largest difference [m] between the supports of a solid and of a hull, along directions spread over the sphere."""
    hull = (DIRECTIONS @ corners.T).max(axis=1)
    mine = np.array([(solid.lowest_points(-direction) @ direction).max() for direction in DIRECTIONS])
    return float(np.abs(hull - mine).max())


def _few_vertices(corners: Array, planes: Array, tolerance: float) -> Array:
    """Some of a hull's corners (n, 3), whose own hull is within a tolerance of it unless that takes too many."""
    directions = np.vstack([planes[:, :3], DIRECTIONS])
    heights = directions @ corners.T
    supports = heights.max(axis=1)
    chosen = sorted({int(k) for k in heights[-6:].argmax(axis=1)})
    while len(chosen) < min(HULL_MAX_VERTICES, len(corners)):
        missing = supports - heights[:, chosen].max(axis=1)
        if len(chosen) >= 6 and missing.max() <= tolerance:
            break
        worst = int(heights[missing.argmax()].argmax())
        if worst in chosen:
            break
        chosen.append(worst)
    return corners[chosen]


def _coal_hull(vertices: Array | None) -> coal.ShapeBase:
    assert vertices is not None
    points = coal.StdVec_Vec3s()
    points.extend(list(vertices))
    return coal.ConvexBase.convexHull(points, True, "Qt")


def _acted(placement: pin.SE3, points: Array) -> Array:
    return points @ placement.rotation.T + placement.translation
