"""The Pinocchio model of what MuJoCo has compiled, number by number, so that the two agree by construction."""

import mujoco
import numpy as np
import pinocchio as pin

Array = np.ndarray

AXIS_JOINTS = (
    (pin.JointModelRX, (1.0, 0.0, 0.0)),
    (pin.JointModelRY, (0.0, 1.0, 0.0)),
    (pin.JointModelRZ, (0.0, 0.0, 1.0)),
)


def pinocchio_model(compiled: mujoco.MjModel) -> pin.Model:
    """A Pinocchio model of a robot or of things that MuJoCo has compiled.

    Joints, bodies and sites have MuJoCo's names and order. Several hinges of one body become a chain of joints, all but
    the last without mass. Every joint, body and site is a frame.

    Args:
        compiled: trees of bodies; a root may have a free joint, all other joints turn about one axis or slide.
    """
    model = pin.Model()
    model.name = compiled.names.split(b"\0", 1)[0].decode()
    carriers = {0: (0, pin.SE3.Identity())}  # body -> the joint that moves it, and its place there
    for body in range(1, compiled.nbody):
        joint, place = carriers[int(compiled.body_parentid[body])]
        first, count = int(compiled.body_jntadr[body]), int(compiled.body_jntnum[body])
        if count and compiled.jnt_type[first] == mujoco.mjtJoint.mjJNT_FREE:
            name = compiled.joint(first).name
            joint, place = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), name), pin.SE3.Identity()
            model.addJointFrame(joint)
        else:
            place = place * placement(compiled.body_pos[body], compiled.body_quat[body])
            for k in range(first, first + count):
                anchor = pin.SE3(np.eye(3), compiled.jnt_pos[k].copy())
                joint = _add_axis_joint(model, compiled, k, joint, place * anchor)
                place = anchor.inverse()
        carriers[body] = joint, place
        model.appendBodyToJoint(joint, _inertia(compiled, body), place)
        model.addFrame(pin.Frame(compiled.body(body).name, joint, _frame(model, joint), place, pin.FrameType.BODY))
    for site in range(compiled.nsite):
        joint, place = carriers[int(compiled.site_bodyid[site])]
        place = place * placement(compiled.site_pos[site], compiled.site_quat[site])
        frame = pin.Frame(compiled.site(site).name, joint, _frame(model, joint), place, pin.FrameType.OP_FRAME)
        model.addFrame(frame)
    return model


def placement(position: Array, quaternion: Array) -> pin.SE3:
    """A place from MuJoCo's position (3,) and quaternion wxyz (4,)."""
    w, x, y, z = quaternion
    return pin.SE3(pin.Quaternion(w, x, y, z).normalized().matrix(), np.array(position, dtype=float))


def _add_axis_joint(model: pin.Model, compiled: mujoco.MjModel, k: int, parent: int, place: pin.SE3) -> int:
    axis, dof = compiled.jnt_axis[k].copy(), int(compiled.jnt_dofadr[k])
    reference = float(compiled.qpos0[compiled.jnt_qposadr[k]])
    if compiled.jnt_type[k] == mujoco.mjtJoint.mjJNT_SLIDE:
        place = place * pin.SE3(np.eye(3), -reference * axis)
        kind: pin.JointModel = pin.JointModelPrismaticUnaligned(axis)
    else:
        if reference:
            place = place * pin.SE3(pin.AngleAxis(-reference, axis).toRotationMatrix(), np.zeros(3))
        plain = next((plain() for plain, along in AXIS_JOINTS if tuple(axis) == along), None)
        kind = plain or pin.JointModelRevoluteUnaligned(axis)
    joint = model.addJoint(parent, kind, place, compiled.joint(k).name)
    model.addJointFrame(joint)
    v, q = model.idx_vs[joint], model.idx_qs[joint]
    lower, upper = compiled.jnt_range[k] if compiled.jnt_limited[k] else (-np.inf, np.inf)
    model.lowerPositionLimit[q], model.upperPositionLimit[q] = lower, upper
    model.armature[v], model.damping[v] = (
        compiled.dof_armature[dof],
        compiled.dof_damping.reshape(compiled.nv, -1)[dof, 0],
    )
    model.upperDryFrictionLimit[v] = compiled.dof_frictionloss[dof]
    model.lowerDryFrictionLimit[v] = -compiled.dof_frictionloss[dof]
    return joint


def _inertia(compiled: mujoco.MjModel, body: int) -> pin.Inertia:
    principal = placement(compiled.body_ipos[body], compiled.body_iquat[body])
    turning = principal.rotation @ np.diag(compiled.body_inertia[body]) @ principal.rotation.T
    return pin.Inertia(float(compiled.body_mass[body]), principal.translation, 0.5 * (turning + turning.T))


def _frame(model: pin.Model, joint: int) -> int:
    """The joint's own frame, which carries those of its bodies and sites."""
    return int(model.getFrameId(model.names[joint], pin.FrameType.JOINT))
