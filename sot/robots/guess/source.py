"""The MuJoCo model that a guess starts from: bodies, joints and geometry of a model file, its meshes as hulls."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
from scipy.spatial import ConvexHull, QhullError

from sot.errors import InputError
from sot.robots.reading.mjcf_file import mjcf_spec
from sot.robots.reading.solid import Solid, fitted_primitive
from sot.robots.reading.urdf import solid_or_mesh

BASE = 1  # Pinocchio's joint of the floating base


def original_model(path: Path) -> mujoco.MjModel:
    """The compiled model of an MJCF or a URDF (`.urdf`), its base free, with all of its joints.

    Unlike `sot.robots.reading.read_model`, it takes a robot that still has fingers that slide and joints that follow
    others, and keeps the meshes' own hulls: what a robot file has to say of these is yet to be found out.

    Raises:
        InputError: the file cannot be read.
    """
    try:
        spec = _urdf_spec(path) if path.suffix.lower() == ".urdf" else mjcf_spec(path)
        spec.compiler.balanceinertia = True
        _free_base(spec)
        return spec.compile()
    except (ValueError, RuntimeError, IndexError, OSError, mujoco.FatalError) as error:
        raise InputError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None


def _free_base(spec: mujoco.MjSpec) -> None:
    """Free the root of the largest tree, if the model fixes it to the world."""
    roots = list(spec.worldbody.bodies)
    if not roots:
        raise ValueError("there is no body in it")
    base = max(roots, key=lambda root: len(root.find_all(mujoco.mjtObj.mjOBJ_JOINT)))
    if not base.joints:
        base.add_freejoint(name="root")


def _urdf_spec(path: Path) -> mujoco.MjSpec:
    """A URDF as Pinocchio reads it: MuJoCo stops at meshes it has no format for."""
    folders = [str(folder) for folder in path.resolve().parents]
    model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    spec = mujoco.MjSpec()
    spec.modelname = model.name
    spec.compiler.degree = False
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.compiler.boundmass, spec.compiler.boundinertia = 1e-6, 1e-9
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    bodies = {0: spec.worldbody}
    for joint in range(BASE, model.njoints):
        place, inertia = model.jointPlacements[joint], model.inertias[joint]
        frames = (f for f in model.frames if f.parentJoint == joint and f.type == pin.FrameType.BODY)
        name = str(next(frames).name)
        body = bodies[model.parents[joint]].add_body(name=name, pos=place.translation, quat=_wxyz(place))
        bodies[joint] = body
        turning = inertia.inertia
        body.explicitinertial = True
        body.mass, body.ipos = inertia.mass, inertia.lever
        body.fullinertia = [*np.diag(turning), turning[0, 1], turning[0, 2], turning[1, 2]]
        if joint > BASE:
            _add_joint(body, model, data, joint)
    for kind, visible in ((pin.GeometryType.COLLISION, False), (pin.GeometryType.VISUAL, True)):
        for shape in pin.buildGeomFromUrdf(model, str(path), kind, package_dirs=folders).geometryObjects:
            replace(_solid(shape), name="").add_to(spec, bodies[shape.parentJoint], visible)
    return spec


def _add_joint(body: mujoco.MjsBody, model: pin.Model, data: pin.Data, joint: int) -> None:
    v, q = model.idx_vs[joint], model.idx_qs[joint]
    turn, slide = (data.oMi[joint].rotation.T @ data.J[rows, v] for rows in (slice(3, 6), slice(0, 3)))
    kind = mujoco.mjtJoint.mjJNT_HINGE if turn.any() else mujoco.mjtJoint.mjJNT_SLIDE
    own = body.add_joint(name=model.names[joint], type=kind, axis=turn if turn.any() else slide)
    limited = model.nqs[joint] == 1
    own.limited = mujoco.mjtLimited.mjLIMITED_TRUE if limited else mujoco.mjtLimited.mjLIMITED_FALSE
    if limited:
        own.range = [model.lowerPositionLimit[q], model.upperPositionLimit[q]]
    effort = model.upperEffortLimit[v]
    own.actfrclimited = mujoco.mjtLimited.mjLIMITED_TRUE if effort > 0.0 else mujoco.mjtLimited.mjLIMITED_FALSE
    own.actfrcrange = [-effort, effort]


def _solid(shape: pin.GeometryObject) -> Solid:
    """A shape of a URDF; of a mesh its convex hull."""
    solid = solid_or_mesh(shape)
    if isinstance(solid, Solid):
        return solid
    try:
        vertices = solid.vertices[ConvexHull(solid.vertices).vertices]
    except QhullError:  # flat
        return fitted_primitive([solid])
    centre = vertices.mean(axis=0)
    return Solid("", "hull", np.zeros(3), pin.SE3(np.eye(3), centre), vertices - centre, rgba=solid.rgba)


def _wxyz(place: pin.SE3) -> list[float]:
    x, y, z, w = pin.Quaternion(place.rotation).coeffs()
    return [w, x, y, z]
