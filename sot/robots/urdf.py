"""A robot from a URDF: Pinocchio's model of it, and the MJCF text that MuJoCo reads instead.

MuJoCo's own reading of a URDF stops at meshes it has no format for, and leaves out what a URDF cannot say. Here both
get the same bodies, joints and inertias, and primitives in the place of meshes: for looks and for collisions.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.models.mjcf import number_text

Array = np.ndarray

BASE = 1  # the joint of the floating base
COINCIDENCE_DISTANCE = 1e-6  # m, joints this close turn about one point
CAPSULE_MIN_ROUNDNESS = 0.6  # least ratio of a long mesh's two other sides that makes it a capsule rather than a box
CAPSULE_MIN_SLENDERNESS = 1.3  # least ratio of a capsule's length to its thickness
SOLE_BOX_HEIGHT = 0.02  # m, of the box over a sole
TOUCHING_DISTANCE = 0.005  # m, shapes nearer than this at rest are not meant to collide


@dataclass(frozen=True)
class Urdf:
    """What a URDF says.

    Attributes:
        model: Pinocchio's, with a free base and without the locked joints.
        shapes, looks: primitives to collide and to be seen.
    """

    model: pin.Model
    shapes: pin.GeometryModel
    looks: pin.GeometryModel

    @staticmethod
    def read(path: Path, locked: Mapping[str, float]) -> "Urdf":
        """Read a file; joints in `locked` are held at an angle [rad] and become part of the body that carries them.

        Meshes of ROS packages (`package://`) are looked for in the folders above the file.

        Raises:
            InputError: Pinocchio cannot read the file or one of its meshes, or has no joint of that name.
        """
        folders = [str(folder) for folder in path.resolve().parents]
        try:
            model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
            geometries = [
                pin.buildGeomFromUrdf(model, str(path), kind, package_dirs=folders)
                for kind in (pin.GeometryType.COLLISION, pin.GeometryType.VISUAL)
            ]
        except (ValueError, RuntimeError, IndexError) as error:
            raise InputError(f"{path}: Pinocchio cannot read it: {str(error).splitlines()[0]}") from None
        q = pin.neutral(model)
        for joint, angle in locked.items():
            if not BASE < model.getJointId(joint) < model.njoints:
                raise InputError(f"{path}: no joint '{joint}' to lock")
            q[model.joints[model.getJointId(joint)].idx_q] = angle
        if locked:
            ids = [model.getJointId(joint) for joint in locked]
            model, geometries = pin.buildReducedModel(model, geometries, ids, q)
        return Urdf(model, _collision_shapes(model, geometries[0]), _visual_primitives(geometries[1]))

    def with_soles(self, soles: Mapping[int, Array]) -> "Urdf":
        """The same, but what a foot collides with is a box over its sole.

        Args:
            soles: joint -> corners of the sole (n, 3) in the joint's frame, flat along its z axis [m].
        """
        shapes = self.shapes.copy()
        for name in [shape.name for shape in shapes.geometryObjects if shape.parentJoint in soles]:
            shapes.removeGeometryObject(name)
        for joint, corners in soles.items():
            low, high = corners.min(axis=0), corners.max(axis=0)
            high[2] = low[2] + SOLE_BOX_HEIGHT
            box = coal.Box(*(high - low))
            name = f"{self.model.names[joint]}_sole"
            shapes.addGeometryObject(pin.GeometryObject(name, joint, pin.SE3(np.eye(3), (low + high) / 2), box))
        return Urdf(self.model, shapes, self.looks)

    def mjcf(self, name: str, rest: Array) -> str:
        """The MJCF text: bodies and joints in the model's order.

        Args:
            name: of the model.
            rest: configuration (nq,) in which shapes that touch are not meant to collide.
        """
        root = ET.Element("mujoco", model=name)
        ET.SubElement(root, "compiler", angle="radian")
        bodies = {0: ET.SubElement(root, "worldbody")}
        for joint in range(BASE, self.model.njoints):
            bodies[joint] = _add_body(bodies[self.model.parents[joint]], self.model, joint)
            bodies[joint].set("name", self._link_name(joint))
        for looks in (True, False):
            for geometry in (self.looks if looks else self.shapes).geometryObjects:
                _add_geom(bodies[geometry.parentJoint], geometry, looks)
        contact = ET.SubElement(root, "contact")
        for first, second in self._excluded_pairs(rest):
            ET.SubElement(contact, "exclude", body1=self._link_name(first), body2=self._link_name(second))
        ET.indent(root)
        return ET.tostring(root, encoding="unicode") + "\n"

    def _link_name(self, joint: int) -> str:
        """Name of the link right behind a joint."""
        return next(
            frame.name for frame in self.model.frames if frame.parentJoint == joint and frame.type == pin.FrameType.BODY
        )

    def _excluded_pairs(self, rest: Array) -> list[tuple[int, int]]:
        """Joints whose bodies are not meant to collide: neighbours about one point, and what touches at rest."""
        model, shapes = self.model, self.shapes.copy()
        shapes.addAllCollisionPairs()
        results = shapes.createData()
        pin.computeDistances(model, model.createData(), shapes, results, rest)
        apart = {(j, i) for i in range(BASE + 1, model.njoints) for j in _neighbours(model, i)}
        for pair, result in zip(shapes.collisionPairs, results.distanceResults, strict=True):
            if result.min_distance < TOUCHING_DISTANCE:
                joints = (shapes.geometryObjects[k].parentJoint for k in (pair.first, pair.second))
                first, second = sorted(joints)
                apart.add((first, second))
        return sorted(apart)


def _neighbours(model: pin.Model, joint: int) -> Iterator[int]:
    """The bodies before a joint that one point, at which several joints may turn, links to the body behind it."""
    while joint > BASE:
        coincides = _turns_about_parents_point(model, joint)
        joint = model.parents[joint]
        yield joint
        if not coincides:
            return


def _turns_about_parents_point(model: pin.Model, joint: int) -> bool:
    """Whether a joint turns about the same point as the one before it."""
    return bool(np.linalg.norm(model.jointPlacements[joint].translation) < COINCIDENCE_DISTANCE)


def _collision_shapes(model: pin.Model, geometry: pin.GeometryModel) -> pin.GeometryModel:
    """Shapes to collide: a link's own primitives, and one about all its meshes.

    What lies between joints that turn about one point, the housing of a hip or a shoulder, cannot help overlapping with
    the links on both sides and has no shape.
    """
    housings = {model.parents[j] for j in range(BASE + 1, model.njoints) if _turns_about_parents_point(model, j)} - {
        BASE
    }
    out, meshes = pin.GeometryModel(), dict[int, list[pin.GeometryObject]]()
    for shape in geometry.geometryObjects:
        if shape.parentJoint in housings:
            continue
        if isinstance(shape.geometry, coal.BVHModelBase):
            meshes.setdefault(shape.parentJoint, []).append(shape)
        else:
            out.addGeometryObject(shape)
    for joint, parts in meshes.items():
        solid, placement = _fitted_primitive(parts)
        out.addGeometryObject(pin.GeometryObject(f"{model.names[joint]}_meshes", joint, placement, solid))
    return out


def _visual_primitives(geometry: pin.GeometryModel) -> pin.GeometryModel:
    """The same shapes, each mesh replaced by a primitive about it."""
    out = pin.GeometryModel()
    for shape in geometry.geometryObjects:
        solid, placement = shape.geometry, shape.placement
        if isinstance(solid, coal.BVHModelBase):
            solid, placement = _fitted_primitive([shape])
        simple = pin.GeometryObject(shape.name, shape.parentJoint, placement, solid)
        simple.meshColor = shape.meshColor
        out.addGeometryObject(simple)
    return out


def _fitted_primitive(meshes: Sequence[pin.GeometryObject]) -> tuple[coal.ShapeBase, pin.SE3]:
    """A capsule about the meshes of one joint if they are long and round, else a box; and its place in the joint.

    It lies along the axes, of the joint or of one of the meshes, that make it least.
    """
    places = [mesh.placement for mesh in meshes]
    vertices = np.vstack(
        [
            mesh.geometry.vertices() @ place.rotation.T + place.translation
            for mesh, place in zip(meshes, places, strict=True)
        ]
    )
    axes = [np.eye(3), *(place.rotation for place in places)]
    turn = min(axes, key=lambda axes: np.prod(np.ptp(vertices @ axes, axis=0)))
    low, high = (vertices @ turn).min(axis=0), (vertices @ turn).max(axis=0)
    half, centre = (high - low) / 2, turn @ (low + high) / 2
    longest = int(half.argmax())
    others = np.delete(half, longest)
    radius = float(others.mean())
    if half[longest] < CAPSULE_MIN_SLENDERNESS * radius or others.min() < CAPSULE_MIN_ROUNDNESS * others.max():
        return coal.Box(*(2 * half)), pin.SE3(turn, centre)
    along = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), turn[:, longest]).matrix()
    return coal.Capsule(radius, 2 * float(half[longest] - radius)), pin.SE3(along, centre)


def _add_body(parent: ET.Element, model: pin.Model, joint: int) -> ET.Element:
    place, inertia = model.jointPlacements[joint], model.inertias[joint]
    body = ET.SubElement(parent, "body", _place_attributes(place))
    if joint == BASE:
        ET.SubElement(body, "freejoint", name="root")
    else:
        v, q = model.joints[joint].idx_v, model.joints[joint].idx_q
        limits = (model.lowerPositionLimit[q], model.upperPositionLimit[q])
        dynamics = {
            "armature": number_text(model.armature[v]),
            "damping": number_text(model.damping[v]),
            "frictionloss": number_text(model.upperDryFrictionLimit[v]),
        }
        axis = _joint_axis(model, joint)
        ET.SubElement(
            body, "joint", dynamics, name=model.names[joint], axis=_exact_text(axis), range=_exact_text(limits)
        )
    turning = inertia.inertia
    full = (*np.diag(turning), turning[0, 1], turning[0, 2], turning[1, 2])
    pos, mass = _exact_text(inertia.lever), _exact_text([inertia.mass])
    ET.SubElement(body, "inertial", pos=pos, mass=mass, fullinertia=_exact_text(full))
    return body


def _joint_axis(model: pin.Model, joint: int) -> Array:
    """Of a joint, in its own frame (3,)."""
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    return data.oMi[joint].rotation.T @ data.J[3:, model.joints[joint].idx_v]


def _add_geom(body: ET.Element, shape: pin.GeometryObject, looks: bool) -> None:
    kind, size = _geom_type_and_size(shape.geometry)
    of = {"type": kind, "size": _exact_text(size), "rgba": number_text(shape.meshColor)} | _place_attributes(
        shape.placement
    )
    of |= {"contype": "0", "conaffinity": "0", "group": "2"} if looks else {"name": shape.name, "group": "3"}
    ET.SubElement(body, "geom", of)


def _geom_type_and_size(solid: coal.CollisionGeometry) -> tuple[str, Iterable[float]]:
    match solid:
        case coal.Box():
            return "box", solid.halfSide
        case coal.Sphere():
            return "sphere", [solid.radius]
        case coal.Capsule():
            return "capsule", [solid.radius, solid.halfLength]
        case coal.Cylinder():
            return "cylinder", [solid.radius, solid.halfLength]
    raise TypeError(f"{type(solid).__name__} is no shape of a URDF")


def _place_attributes(place: pin.SE3) -> dict[str, str]:
    x, y, z, w = pin.Quaternion(place.rotation).coeffs()
    return {"pos": _exact_text(place.translation), "quat": _exact_text((w, x, y, z))}


def _exact_text(values: Iterable[float]) -> str:
    """Numbers to the last digit: dynamics computed from either text or model agree to rounding."""
    return " ".join(repr(float(value)) for value in values)
