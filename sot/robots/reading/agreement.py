"""Whether two readings of one robot mean the same: places of all links, masses, centre of mass and mass matrix."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.reading.pinocchio_model import placement

Array = np.ndarray

POSES = 3
POSITION_TOLERANCE = 1e-6  # m, also of turned unit vectors
RELATIVE_TOLERANCE = 1e-6  # of masses, and of a mass matrix by its largest entry


class Reading(NamedTuple):
    """What a library makes of a robot in one pose.

    Attributes:
        links: name -> place relative to the base.
        mass: of the whole robot [kg].
        com: its centre of mass relative to the base (3,) [m].
        inertia: the joints' part of the mass matrix, without armature (na, na) [kg m²].
    """

    links: Mapping[str, pin.SE3]
    mass: float
    com: Array
    inertia: Array


def seeded_poses(lower: Array, upper: Array, rest: Array) -> list[Array]:
    """Angles (na,) at rest and some random ones, within ranges where there are any [rad]."""
    rng = np.random.default_rng(0)
    low, high = np.maximum(lower, rest - 1.0), np.minimum(upper, rest + 1.0)
    return [rest, *(rng.uniform(np.minimum(low, high), np.maximum(low, high)) for _ in range(POSES))]


def pinocchio_reading(model: pin.Model, joints: Sequence[str], angles: Array) -> Reading:
    """What Pinocchio makes of a robot with its joints, a free base's left out, at some angles (na,) [rad]."""
    data, q = model.createData(), pin.neutral(model)
    dofs = []
    for name, angle in zip(joints, angles, strict=True):
        joint = model.getJointId(name)
        at = model.idx_qs[joint]
        q[at : at + model.nqs[joint]] = (angle,) if model.nqs[joint] == 1 else (np.cos(angle), np.sin(angle))
        dofs.append(model.idx_vs[joint])
    pin.framesForwardKinematics(model, data, q)
    links = {f.name: data.oMf[k] for k, f in enumerate(model.frames) if f.type == pin.FrameType.BODY and f.parentJoint}
    M = pin.crba(model, data, q)
    M = np.triu(M) + np.triu(M, 1).T - np.diag(model.armature)
    mass = pin.computeTotalMass(model)
    return Reading(links, mass, pin.centerOfMass(model, data, q), M[np.ix_(dofs, dofs)])


def mujoco_reading(
    compiled: mujoco.MjModel, base: int, joints: Sequence[int], locked: Mapping[int, float], angles: Array
) -> Reading:
    """What MuJoCo makes of a robot.

    Args:
        compiled: the model, which may hold more than the robot.
        base: the body at the robot's root.
        joints: numbers of its joints.
        locked: joints that are held -> angle or place.
        angles: of the joints (na,) [rad].
    """
    data = mujoco.MjData(compiled)
    for joint, angle in [*zip(joints, angles, strict=True), *locked.items()]:
        if compiled.jnt_type[joint] != mujoco.mjtJoint.mjJNT_BALL:
            data.qpos[compiled.jnt_qposadr[joint]] = angle
    mujoco.mj_kinematics(compiled, data)
    mujoco.mj_comPos(compiled, data)
    mujoco.mj_makeM(compiled, data)
    M = np.zeros((compiled.nv, compiled.nv))
    mujoco.mj_fullM(compiled, data, M)
    dofs = compiled.jnt_dofadr[list(joints)]
    M -= np.diag(compiled.dof_armature)
    origin = placement(data.xpos[base], data.xquat[base])
    bodies = np.flatnonzero(compiled.body_rootid == compiled.body_rootid[base])
    links = {compiled.body(b).name: origin.actInv(placement(data.xpos[b], data.xquat[b])) for b in bodies.tolist()}
    return Reading(
        links, float(compiled.body_mass[bodies].sum()), origin.actInv(data.subtree_com[base]), M[np.ix_(dofs, dofs)]
    )


def refuse_difference(path: Path, ours: Reading, theirs: Reading) -> None:
    """Compare two readings of a robot in one pose.

    Raises:
        InputError: they differ; named is the first link or quantity that does.
    """
    for name in [name for name in ours.links if name in theirs.links]:
        one, other = ours.links[name], theirs.links[name]
        apart = np.abs(one.homogeneous - other.homogeneous).max()
        if not apart <= POSITION_TOLERANCE:
            raise InputError(f"{path}: link '{name}' is read {apart:.3g} m or rad from where it is: please report it")
    for what, one, other in (
        ("the mass", ours.mass, theirs.mass),
        ("the centre of mass", ours.com, theirs.com),
        ("the mass matrix", ours.inertia, theirs.inertia),
    ):
        apart, scale = np.abs(np.subtract(one, other)).max(), max(np.abs(other).max(), 1e-6)
        if not apart <= RELATIVE_TOLERANCE * max(scale, 1.0 if what == "the centre of mass" else 0.0):
            raise InputError(f"{path}: {what} is read wrong, by {apart:.3g} of {scale:.3g}: please report it")
