"""The MuJoCo model that a guess starts from: bodies, joints and the geometry of a model file as it is."""

from pathlib import Path

import coal
import mujoco
import numpy as np
import pinocchio as pin

from sot.errors import InputError


def original_model(path: Path) -> mujoco.MjModel:
    """The compiled model of an MJCF or a URDF, with a free base and its own meshes.

    Raises:
        InputError: the file cannot be read.
    """
    try:
        if path.suffix == ".urdf":
            return _from_urdf(path)
        return mujoco.MjSpec.from_file(str(path)).compile()
    except (ValueError, RuntimeError, IndexError) as error:
        raise InputError(f"{path}: cannot be read: {str(error).splitlines()[0]}") from None


def _from_urdf(path: Path) -> mujoco.MjModel:
    folders = [str(folder) for folder in path.resolve().parents]
    model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    spec = mujoco.MjSpec()
    spec.modelname = model.name
    spec.compiler.degree = False
    spec.compiler.balanceinertia = True
    spec.compiler.boundmass = 1e-6
    spec.compiler.boundinertia = 1e-9
    bodies = {0: spec.worldbody}
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    for j in range(1, model.njoints):
        name = next(f.name for f in model.frames if f.parentJoint == j and f.type == pin.FrameType.BODY)
        place, inertia = model.jointPlacements[j], model.inertias[j]
        body = bodies[model.parents[j]].add_body(name=name, pos=place.translation, quat=_wxyz(place.rotation))
        bodies[j] = body
        if j == 1:
            body.add_freejoint(name="root")
        else:
            v, q = model.joints[j].idx_v, model.joints[j].idx_q
            axis = data.oMi[j].rotation.T @ data.J[3:, v]
            kind = mujoco.mjtJoint.mjJNT_HINGE
            if not axis.any():
                axis, kind = data.oMi[j].rotation.T @ data.J[:3, v], mujoco.mjtJoint.mjJNT_SLIDE
            effort = model.upperEffortLimit[v]
            body.add_joint(
                name=model.names[j],
                type=kind,
                axis=axis,
                range=[model.lowerPositionLimit[q], model.upperPositionLimit[q]],
                limited=True,
                actfrcrange=[-effort, effort],
                actfrclimited=effort > 0,
            )
        inertial = inertia.inertia
        body.explicitinertial = True
        body.mass = inertia.mass
        body.ipos = inertia.lever
        body.fullinertia = [*np.diag(inertial), inertial[0, 1], inertial[0, 2], inertial[1, 2]]
    for kind, visible in ((pin.GeometryType.COLLISION, False), (pin.GeometryType.VISUAL, True)):
        geometry = pin.buildGeomFromUrdf(model, str(path), kind, package_dirs=folders)
        for shape in geometry.geometryObjects:
            _add(spec, bodies[shape.parentJoint], shape, visible)
    return spec.compile()


def _add(spec: mujoco.MjSpec, body, shape: pin.GeometryObject, visible: bool) -> None:  # type: ignore[no-untyped-def]
    place, solid = shape.placement, shape.geometry
    common = {"pos": place.translation, "quat": _wxyz(place.rotation), "group": 2 if visible else 3}
    if visible:
        common |= {"contype": 0, "conaffinity": 0}
    kinds = mujoco.mjtGeom
    match solid:
        case coal.Box():
            body.add_geom(type=kinds.mjGEOM_BOX, size=solid.halfSide, **common)
        case coal.Sphere():
            body.add_geom(type=kinds.mjGEOM_SPHERE, size=[solid.radius, 0, 0], **common)
        case coal.Capsule():
            body.add_geom(type=kinds.mjGEOM_CAPSULE, size=[solid.radius, solid.halfLength, 0], **common)
        case coal.Cylinder():
            body.add_geom(type=kinds.mjGEOM_CYLINDER, size=[solid.radius, solid.halfLength, 0], **common)
        case coal.BVHModelBase():
            vertices = np.asarray(solid.vertices())
            name = f"{shape.name}_{visible}"
            solid.buildConvexHull(True, "Qt") if hasattr(solid, "buildConvexHull") else None
            hull = vertices
            mesh = spec.add_mesh(name=name)
            mesh.uservert = hull.ravel()
            mesh.userface = _faces(solid).ravel()
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
            body.add_geom(type=kinds.mjGEOM_MESH, meshname=name, **common)


def _faces(solid: coal.BVHModelBase) -> np.ndarray:
    return np.array([[int(solid.tri_indices(k)[i]) for i in range(3)] for k in range(solid.num_tris)])


def _wxyz(rotation: np.ndarray) -> list[float]:
    x, y, z, w = pin.Quaternion(rotation).coeffs()
    return [w, x, y, z]
