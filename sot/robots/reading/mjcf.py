"""A robot from an MJCF: what MuJoCo itself makes of the file, with the robot's own tree picked out of it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.reading.pinocchio_model import placement
from sot.robots.reading.shapes import with_solids
from sot.robots.reading.solid import GEOMS, VISUAL_GROUP, Mesh, Solid, fitted_primitive
from sot.robots.reading.tree import Hinge, Link, Tree, unique_name

Array = np.ndarray

KINDS = {int(geom): kind for kind, geom in GEOMS.items() if kind != "hull"}
MESH = int(mujoco.mjtGeom.mjGEOM_MESH)
FREE, BALL, SLIDE, HINGE = (
    int(kind)
    for kind in (
        mujoco.mjtJoint.mjJNT_FREE,
        mujoco.mjtJoint.mjJNT_BALL,
        mujoco.mjtJoint.mjJNT_SLIDE,
        mujoco.mjtJoint.mjJNT_HINGE,
    )
)


class KeyFrame(NamedTuple):
    """A posture that a model names: rotation of the base (3, 3), and joint -> angle [rad]."""

    rotation: Array
    angles: Mapping[str, float]


class RobotInModel(NamedTuple):
    """A robot in a compiled model.

    Attributes:
        tree: the robot.
        key_frames: by name.
        base: the body at its root.
        joints: joint -> number, of all that are not the base's, locked ones included.
    """

    tree: Tree
    key_frames: Mapping[str, KeyFrame]
    base: int
    joints: Mapping[str, int]


def find_robot(compiled: mujoco.MjModel, path: Path, locked: Mapping[str, float], remarks: list[str]) -> RobotInModel:
    """The robot in a model: the tree with the most joints.

    Args:
        compiled: MuJoCo's reading of the whole file.
        path: of the file, for messages.
        locked: joints that are held, with their angles [rad] or places [m].
        remarks: what is left out or not modelled is added to these.

    Raises:
        InputError: a joint to be locked does not exist, or one that is not turns about no axis.
    """
    base = _base(compiled, path, remarks)
    bodies = [body for body in range(1, compiled.nbody) if compiled.body_rootid[body] == base]
    names = _body_names(compiled, bodies)
    joints = _joint_names(compiled, bodies, names)
    unknown = [name for name in locked if name not in joints.values()]
    if unknown:
        raise InputError(f"{path}: no joint '{unknown[0]}' to lock")
    _refuse_others(compiled, path, {k: name for k, name in joints.items() if name not in locked})
    index = {body: k for k, body in enumerate(bodies)}
    efforts = joint_efforts(compiled)
    links = []
    for body in bodies:
        place = pin.SE3.Identity() if body == base else placement(compiled.body_pos[body], compiled.body_quat[body])
        link = Link(
            name=names[body],
            parent=-1 if body == base else index[int(compiled.body_parentid[body])],
            placement=place,
            joints=tuple(_hinge(compiled, k, joints[k], efforts[k]) for k in _joints(compiled, body) if k in joints),
            inertia=_inertia(compiled, body),
            sites=_sites(compiled, body),
        )
        kinds = {joints[k]: int(compiled.jnt_type[k]) for k in _joints(compiled, body) if k in joints}
        links.append(_with_locked(link, locked, kinds))
    shapes, looks = _shapes_and_looks(compiled, bodies, remarks)
    links = [replace(link, looks=tuple(looks.get(k, ()))) for k, link in enumerate(links)]
    _remark_on_what_is_not_modelled(compiled, joints, locked, remarks)
    tree = Tree(path.stem, tuple(links), excluded=_excluded(compiled, names))
    key_frames = _key_frames(compiled, base, joints)
    return RobotInModel(with_solids(tree, shapes), key_frames, base, {name: k for k, name in joints.items()})


def _joints(compiled: mujoco.MjModel, body: int) -> range:
    first = int(compiled.body_jntadr[body])
    return range(first, first + int(compiled.body_jntnum[body]))


def _base(compiled: mujoco.MjModel, path: Path, remarks: list[str]) -> int:
    """The body at the root of the robot."""
    roots = [body for body in range(1, compiled.nbody) if compiled.body_parentid[body] == 0]
    if not roots:
        raise InputError(f"{path}: there is no body in it: give the robot's own model file")
    counts = {root: int((compiled.body_rootid[compiled.jnt_bodyid] == root).sum()) for root in roots}
    base = max(roots, key=lambda root: counts[root])
    left_out = [compiled.body(root).name or f"body {root}" for root in roots if root != base]
    if left_out:
        remarks.append(f"left out of the model, since they are not of the robot: {', '.join(left_out)}")
    kinds = [int(compiled.jnt_type[k]) for k in _joints(compiled, base)]
    name = compiled.body(base).name
    if not kinds:
        remarks.append(f"the base '{name}' is fixed to the world in the model: it is free here")
    elif kinds != [FREE]:
        raise InputError(f"{path}: the base '{name}' needs one free joint, or none, and no other joints")
    else:
        dof = int(compiled.jnt_dofadr[compiled.body_jntadr[base]])
        if compiled.dof_armature[dof] or compiled.dof_frictionloss[dof] or np.any(compiled.dof_damping[dof]):
            remarks.append("armature, damping and friction of the free base are left out: nothing holds it")
    return base


def _body_names(compiled: mujoco.MjModel, bodies: Sequence[int]) -> dict[int, str]:
    names: dict[int, str] = {}
    for body in bodies:
        names[body] = unique_name(compiled.body(body).name or f"body_{body}", names.values())
    return names


def _joint_names(compiled: mujoco.MjModel, bodies: Sequence[int], links: Mapping[int, str]) -> dict[int, str]:
    """Joint -> name, of all but the free one; a joint without a name is called after its link."""
    names: dict[int, str] = {}
    for body in bodies:
        for k in _joints(compiled, body):
            if compiled.jnt_type[k] != FREE:
                names[k] = unique_name(compiled.joint(k).name or f"{links[body]}_joint", names.values())
    return names


def _refuse_others(compiled: mujoco.MjModel, path: Path, joints: Mapping[int, str]) -> None:
    sliding = [f"'{name}'" for k, name in joints.items() if compiled.jnt_type[k] == SLIDE]
    balls = [f"'{name}'" for k, name in joints.items() if compiled.jnt_type[k] == BALL]
    wrong = [*(f"joint {name} slides" for name in sliding), *(f"joint {name} is a ball joint" for name in balls)]
    if wrong:
        raise InputError(f"{path}: {', '.join(wrong)}: joints turn about one axis; put others into [locked]")
    if not joints:
        raise InputError(f"{path}: the robot has no joints")


def _hinge(compiled: mujoco.MjModel, k: int, name: str, effort: float) -> Hinge:
    dof = int(compiled.jnt_dofadr[k])
    lower, upper = compiled.jnt_range[k].tolist() if compiled.jnt_limited[k] else (-np.inf, np.inf)
    single = compiled.jnt_type[k] in (HINGE, SLIDE)
    return Hinge(
        name=name,
        anchor=compiled.jnt_pos[k].copy(),
        axis=compiled.jnt_axis[k].copy(),
        reference=float(compiled.qpos0[compiled.jnt_qposadr[k]]) if single else 0.0,
        lower=lower,
        upper=upper,
        armature=float(compiled.dof_armature[dof]),
        damping=float(np.ravel(compiled.dof_damping[dof])[0]),
        friction=float(compiled.dof_frictionloss[dof]),
        effort=effort,
    )


def joint_efforts(compiled: mujoco.MjModel) -> Array:
    """Largest torque of each joint's motor, either way (njnt,) [N m]; infinite where the model gives none.

    It is the joint's `actuatorfrcrange`, else `ctrlrange` times gear of a motor, else `forcerange` times gear.
    """
    efforts = np.full(compiled.njnt, np.inf)
    for k in range(compiled.nu):
        if compiled.actuator_trntype[k] != mujoco.mjtTrn.mjTRN_JOINT:
            continue
        gear = abs(float(compiled.actuator_gear[k, 0]))
        bounds = []
        motor = compiled.actuator_biastype[k] == mujoco.mjtBias.mjBIAS_NONE
        if motor and compiled.actuator_ctrllimited[k]:
            gain = abs(float(compiled.actuator_gainprm[k, 0]))
            bounds.append(gain * float(np.abs(compiled.actuator_ctrlrange[k]).min()))
        if compiled.actuator_forcelimited[k]:
            bounds.append(float(np.abs(compiled.actuator_forcerange[k]).min()))
        if bounds:
            efforts[int(compiled.actuator_trnid[k, 0])] = gear * min(bounds)
    for k in range(compiled.njnt):
        if compiled.jnt_actfrclimited[k]:
            efforts[k] = float(np.abs(compiled.jnt_actfrcrange[k]).min())
    return np.where(efforts > 0.0, efforts, np.inf)


def _inertia(compiled: mujoco.MjModel, body: int) -> pin.Inertia:
    principal = placement(compiled.body_ipos[body], compiled.body_iquat[body])
    turning = principal.rotation @ np.diag(compiled.body_inertia[body]) @ principal.rotation.T
    return pin.Inertia(float(compiled.body_mass[body]), principal.translation, 0.5 * (turning + turning.T))


def _sites(compiled: mujoco.MjModel, body: int) -> tuple[tuple[str, pin.SE3], ...]:
    return tuple(
        (compiled.site(k).name, placement(compiled.site_pos[k], compiled.site_quat[k]))
        for k in range(compiled.nsite)
        if compiled.site_bodyid[k] == body and compiled.site(k).name
    )


def _excluded(compiled: mujoco.MjModel, names: Mapping[int, str]) -> frozenset[frozenset[str]]:
    """Pairs of links that the model excludes from collisions."""
    pairs = ((int(signature) >> 16, int(signature) & 0xFFFF) for signature in compiled.exclude_signature)
    return frozenset(frozenset((names[a], names[b])) for a, b in pairs if a in names and b in names)


def _with_locked(link: Link, locked: Mapping[str, float], kinds: Mapping[str, int]) -> Link:
    """The link with some of its joints held; what its frame was before is where its later joints leave it."""
    kept: list[Hinge] = []
    place = link.placement
    for hinge in link.joints:
        if hinge.name not in locked:
            kept.append(hinge)
            continue
        angle = locked[hinge.name]
        if kinds[hinge.name] == HINGE:
            held = hinge.turn(angle)
        elif kinds[hinge.name] == SLIDE:
            held = pin.SE3(np.eye(3), (angle - hinge.reference) * hinge.axis)
        else:
            held = pin.SE3.Identity()
        place = place * held
        kept = [before.moved(held.inverse()) for before in kept]
    return replace(link, placement=place, joints=tuple(kept))


def _shapes_and_looks(
    compiled: mujoco.MjModel, bodies: Sequence[int], remarks: list[str]
) -> tuple[dict[int, list[Solid | Mesh]], dict[int, list[Solid]]]:
    """Link -> what it collides with, and link -> primitives of what is seen of it."""
    shapes: dict[int, list[Solid | Mesh]] = {}
    looks: dict[int, list[Solid]] = {}
    skipped = set()
    for k, body in enumerate(bodies):
        first = int(compiled.body_geomadr[body])
        for geom in range(first, first + int(compiled.body_geomnum[body])):
            shape = shape_of_geom(compiled, geom)
            if shape is None:
                skipped.add(compiled.body(body).name)
                continue
            if shape.contype or shape.conaffinity:
                shapes.setdefault(k, []).append(shape)
            if compiled.geom_group[geom] <= VISUAL_GROUP:
                look = replace(shape, name="") if isinstance(shape, Solid) else fitted_primitive([shape])
                looks.setdefault(k, []).append(look)
    if skipped:
        remarks.append(f"planes, height fields and the like on {', '.join(sorted(skipped))} are left out")
    return shapes, looks


def shape_of_geom(compiled: mujoco.MjModel, geom: int) -> Solid | Mesh | None:
    """A geom in its body; of another kind than primitives and meshes none."""
    place = placement(compiled.geom_pos[geom], compiled.geom_quat[geom])
    material = int(compiled.geom_matid[geom])
    rgba = tuple((compiled.mat_rgba[material] if material >= 0 else compiled.geom_rgba[geom]).tolist())
    friction = float(compiled.geom_friction[geom, 0])
    bits = int(compiled.geom_contype[geom]), int(compiled.geom_conaffinity[geom])
    kind = int(compiled.geom_type[geom])
    if kind in KINDS:
        size, name = compiled.geom_size[geom].copy(), compiled.geom(geom).name
        return Solid(name, KINDS[kind], size, place, None, friction, *bits, rgba)
    if kind != MESH:
        return None
    mesh = int(compiled.geom_dataid[geom])
    first = int(compiled.mesh_vertadr[mesh])
    vertices = compiled.mesh_vert[first : first + int(compiled.mesh_vertnum[mesh])].astype(float)
    # MuJoCo turns a mesh into its principal axes; those of the file are better ones to lie along.
    drawn = placement(np.zeros(3), compiled.mesh_quat[mesh]).rotation.T
    return Mesh(vertices, drawn, rgba, friction, *bits).moved(place)


def _key_frames(compiled: mujoco.MjModel, base: int, joints: Mapping[int, str]) -> dict[str, KeyFrame]:
    frames = {}
    free = compiled.body_jntnum[base] > 0
    adr = int(compiled.jnt_qposadr[compiled.body_jntadr[base]])
    for key in range(compiled.nkey):
        q = compiled.key_qpos[key]
        rotation = placement(np.zeros(3), q[adr + 3 : adr + 7]).rotation if free else np.eye(3)
        single = {k: name for k, name in joints.items() if compiled.jnt_type[k] != BALL}
        angles = {name: float(q[compiled.jnt_qposadr[k]]) for k, name in single.items()}
        frames[compiled.key(key).name or f"key_{key}"] = KeyFrame(rotation, angles)
    return frames


def _remark_on_what_is_not_modelled(
    compiled: mujoco.MjModel, joints: Mapping[int, str], locked: Mapping[str, float], remarks: list[str]
) -> None:
    free = {k: name for k, name in joints.items() if name not in locked}
    springs = [name for k, name in free.items() if np.any(compiled.jnt_stiffness[k])]
    if springs:
        remarks.append(f"springs are not modelled: of {', '.join(springs)}")
    coupled = list(_equalities(compiled, free))
    if coupled:
        remarks.append(f"couplings are not modelled: {', '.join(coupled)}")
    if compiled.ntendon:
        names = [compiled.tendon(k).name or f"tendon {k}" for k in range(compiled.ntendon)]
        remarks.append(f"tendons are not modelled: {', '.join(names)}")
    if np.any(compiled.body_gravcomp):
        remarks.append("compensated gravity is not modelled: every link has its weight")


def _equalities(compiled: mujoco.MjModel, joints: Mapping[int, str]) -> Iterator[str]:
    for k in range(compiled.neq):
        kind = str(mujoco.mjtEq(compiled.eq_type[k]).name).removeprefix("mjEQ_").lower()
        if compiled.eq_type[k] != mujoco.mjtEq.mjEQ_JOINT:
            yield compiled.equality(k).name or f"{kind} {k}"
            continue
        one, other = int(compiled.eq_obj1id[k]), int(compiled.eq_obj2id[k])
        names = [joints[joint] for joint in (one, other) if joint in joints]
        if names:
            yield " and ".join(names)
