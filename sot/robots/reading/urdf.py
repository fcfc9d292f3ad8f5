"""A robot from a URDF, which Pinocchio reads: MuJoCo stops at meshes it has no format for."""

import os
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.reading.shapes import with_solids
from sot.robots.reading.solid import Mesh, Solid, fitted_primitive
from sot.robots.reading.tree import Hinge, Link, Tree

Array = np.ndarray

BASE = 1  # the joint of the floating base
STANDARD_ERROR = 2
MIN_MOMENT = 1e-12  # kg m², below which an inertia is none
BALL_DENSITY = 1000.0  # kg/m³


def read_urdf(path: Path, locked: Mapping[str, float], remarks: list[str]) -> tuple[pin.Model, Tree]:
    """Pinocchio's model of a URDF on a free base, and the same robot as a tree.

    Joints in `locked` are held at an angle [rad] and become part of the link that carries them, as do joints that
    follow others (`<mimic>`), where they are when their leaders are at zero or locked. Meshes of ROS packages
    (`package://`) are looked for in the folders above the file.

    Args:
        path: of the file.
        locked: joint -> angle or place.
        remarks: what is not as the file says is added to these.

    Raises:
        InputError: Pinocchio cannot read the file or one of its meshes, has no joint of that name, or finds a joint
            that turns about no axis, or a link that cannot move as it has no mass.
    """
    folders = [str(folder) for folder in path.resolve().parents]
    complaints: list[str] = []
    loader = coal.CachedMeshLoader()  # many files name one mesh twice, to be seen and to collide
    try:
        followers = _followers(path, locked)
        with _complaints_into(complaints):
            model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
            geometries: Sequence[pin.GeometryModel] = [
                pin.buildGeomFromUrdf(model, str(path), kind, package_dirs=folders, mesh_loader=loader)
                for kind in (pin.GeometryType.COLLISION, pin.GeometryType.VISUAL)
            ]
    except (ValueError, RuntimeError, IndexError, ET.ParseError) as error:
        reason = "; ".join(complaints) or " ".join(str(error).split())
        raise InputError(f"{path}: Pinocchio cannot read it: {reason}") from None
    if any("nertia" in complaint for complaint in complaints):  # read on as if there were none
        raise InputError(f"{path}: {'; '.join(complaints)}")
    remarks += [f"the URDF's parser says: {complaint}" for complaint in complaints]
    unknown = [joint for joint in locked if not BASE < model.getJointId(joint) < model.njoints]
    if unknown:
        raise InputError(f"{path}: no joint '{unknown[0]}' to lock")
    if followers:
        names = ", ".join(followers)
        remarks.append(
            f"joints that follow others do not, they are held where their leaders at rest have them: {names}"
        )
    model, geometries = _with_joints_held(model, geometries, followers | dict(locked))
    _refuse_others(model, path)
    _mend_inertias(model, remarks)
    return model, _tree(model, geometries, path.stem)


@contextmanager
def _complaints_into(complaints: list[str]) -> Iterator[None]:
    """Collect what the parser beneath Pinocchio writes to the standard error itself, instead of in its exceptions."""
    sys.stderr.flush()
    with tempfile.TemporaryFile() as written:
        shown = os.dup(STANDARD_ERROR)
        os.dup2(written.fileno(), STANDARD_ERROR)
        try:
            yield
        finally:
            os.dup2(shown, STANDARD_ERROR)
            os.close(shown)
            written.seek(0)
            lines = written.read().decode(errors="replace").splitlines()
            complaints += [line.removeprefix("Error:").strip() for line in lines if line.startswith("Error:")]


def _followers(path: Path, locked: Mapping[str, float]) -> dict[str, float]:
    """Joints that follow others, with the angle that each has when its leader is at zero, or where it is locked."""
    held = {}
    for joint in ET.parse(path).getroot().iter("joint"):
        mimic = joint.find("mimic")
        name = joint.get("name")
        if mimic is not None and name and name not in locked and joint.get("type") != "fixed":
            leader = locked.get(mimic.get("joint") or "", 0.0)
            held[name] = float(mimic.get("offset") or 0.0) + float(mimic.get("multiplier") or 1.0) * leader
    return held


def _with_joints_held(
    model: pin.Model, geometries: Sequence[pin.GeometryModel], held: Mapping[str, float]
) -> tuple[pin.Model, Sequence[pin.GeometryModel]]:
    if not held:
        return model, geometries
    q = pin.neutral(model)
    for name, angle in held.items():
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 1:
            q[joint.idx_q] = angle
        elif joint.nq == 2:  # continuous: cosine and sine
            q[joint.idx_q : joint.idx_q + 2] = np.cos(angle), np.sin(angle)
    return pin.buildReducedModel(model, list(geometries), [model.getJointId(name) for name in held], q)


def _refuse_others(model: pin.Model, path: Path) -> None:
    wrong = []
    for joint in range(BASE + 1, model.njoints):
        kind = model.joints[joint].shortname()
        if kind.startswith("JointModelP"):
            wrong.append(f"joint '{model.names[joint]}' slides")
        elif not kind.startswith("JointModelR"):
            wrong.append(f"joint '{model.names[joint]}' turns about more than one axis")
    if wrong:
        raise InputError(f"{path}: {', '.join(wrong)}: joints turn about one axis; put others into [locked]")
    if model.njoints <= BASE + 1:
        raise InputError(f"{path}: the robot has no joints")
    for joint in range(BASE, model.njoints):
        inertia, name = model.inertias[joint], _link_name(model, joint)
        what = "the base" if joint == BASE else f"link '{name}' moves and"
        if not inertia.mass > 0.0:
            raise InputError(f"{path}: {what} has no mass or inertia: give it both, or put its joint into [locked]")
        if not np.isfinite(inertia.matrix()).all() or np.linalg.eigvalsh(inertia.inertia)[0] < -MIN_MOMENT:
            raise InputError(f"{path}: {what} has an inertia that is negative or no number")


def _tree(model: pin.Model, geometries: Sequence[pin.GeometryModel], name: str) -> Tree:
    shapes: dict[int, list[Solid | Mesh]] = {}
    for shape in geometries[0].geometryObjects:
        shapes.setdefault(shape.parentJoint - BASE, []).append(solid_or_mesh(shape))
    looks: dict[int, list[Solid]] = {}
    for shape in geometries[1].geometryObjects:
        seen = solid_or_mesh(shape)
        look = replace(seen, name="") if isinstance(seen, Solid) else fitted_primitive([seen])
        looks.setdefault(shape.parentJoint, []).append(look)
    links = []
    for joint in range(BASE, model.njoints):
        link = _link_name(model, joint)
        sites = tuple(
            (frame.name, frame.placement)
            for frame in model.frames
            if frame.parentJoint == joint and frame.type == pin.FrameType.BODY and frame.name != link
        )
        links.append(
            Link(
                name=link,
                parent=model.parents[joint] - BASE,
                placement=model.jointPlacements[joint] if joint > BASE else pin.SE3.Identity(),
                joints=(_hinge(model, joint),) if joint > BASE else (),
                inertia=model.inertias[joint],
                looks=tuple(looks.get(joint, ())),
                sites=sites,
            )
        )
    return with_solids(Tree(name, tuple(links)), shapes)


def _hinge(model: pin.Model, joint: int) -> Hinge:
    v, q, unlimited = model.idx_vs[joint], model.idx_qs[joint], model.nqs[joint] == 2
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    axis = data.oMi[joint].rotation.T @ data.J[3:, v]
    nearest = np.round(axis)
    limits = model.upperVelocityLimit[v], model.upperEffortLimit[v]
    velocity, effort = (float(limit) if 0.0 < limit < 1e300 else np.inf for limit in limits)
    return Hinge(
        name=model.names[joint],
        anchor=np.zeros(3),
        axis=nearest if np.abs(axis - nearest).max() < 1e-12 else axis,
        lower=-np.inf if unlimited else float(model.lowerPositionLimit[q]),
        upper=np.inf if unlimited else float(model.upperPositionLimit[q]),
        armature=float(model.armature[v]),
        damping=float(model.damping[v]),
        friction=float(model.upperDryFrictionLimit[v]),
        velocity=velocity,
        effort=effort,
    )


def _link_name(model: pin.Model, joint: int) -> str:
    """Name of the link right behind a joint."""
    frames = (frame for frame in model.frames if frame.parentJoint == joint and frame.type == pin.FrameType.BODY)
    return str(next(frames).name)


def _mend_inertias(model: pin.Model, remarks: list[str]) -> None:
    """Give each link an inertia that a body can have.

    Masses in a point or on a line get what a ball of their mass has besides; where a moment is larger than the other
    two together, all three become their mean.
    """
    thin, odd = [], []
    for joint in range(BASE, model.njoints):
        inertia = model.inertias[joint]
        turning, mass = inertia.inertia, inertia.mass
        if np.linalg.eigvalsh(turning)[0] < MIN_MOMENT:
            thin.append(_link_name(model, joint))
            radius = (3.0 * mass / (4.0 * np.pi * BALL_DENSITY)) ** (1.0 / 3.0)
            turning = turning + 0.4 * mass * radius**2 * np.eye(3)
        moments = np.linalg.eigvalsh(turning)
        if moments[0] + moments[1] < moments[2] * (1.0 - 1e-9):
            odd.append(_link_name(model, joint))
            turning = moments.mean() * np.eye(3)
        model.inertias[joint] = pin.Inertia(mass, inertia.lever, turning)
    if thin:
        remarks.append(f"links without inertia about some axis have that of a ball of their mass: {', '.join(thin)}")
    if odd:
        remarks.append(f"inertias that no body can have (A + B < C) are mended, of links {', '.join(odd)}")


def solid_or_mesh(shape: pin.GeometryObject) -> Solid | Mesh:
    rgba, place, solid = tuple(shape.meshColor.tolist()), shape.placement, shape.geometry
    match solid:
        case coal.BVHModelBase():
            return Mesh(solid.vertices(), np.eye(3), rgba).moved(place)
        case coal.Box():
            kind, size = "box", list(solid.halfSide)
        case coal.Sphere():
            kind, size = "sphere", [solid.radius, 0.0, 0.0]
        case coal.Capsule():
            kind, size = "capsule", [solid.radius, solid.halfLength, 0.0]
        case coal.Cylinder():
            kind, size = "cylinder", [solid.radius, solid.halfLength, 0.0]
        case _:
            raise TypeError(f"{type(solid).__name__} is no shape of a URDF")
    return Solid(shape.name, kind, np.array(size, dtype=float), place, rgba=rgba)
