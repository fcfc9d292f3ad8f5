"""Sole bodies: what is below the bush of a foot, with its shapes that touch the floor, on passive joints."""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

import mujoco
import numpy as np
import pinocchio as pin

from sot.hardware.compliance import SOLE_MASS_SHARE, FootCompliance, bush_position
from sot.robots.reading.tree import Link, Tree
from sot.robots.robot import Robot

Array = np.ndarray

BUSH_AXES = ("roll", "pitch", "vertical")


def sole_body(foot: str) -> str:
    """Name of the body that is the sole of a foot."""
    return f"{foot}_sole"


def bush_joint(foot: str, axis: str) -> str:
    """Name of the joint of a bush about or along one of `BUSH_AXES`."""
    return f"{foot}_{axis}_bush"


def tree_with_soles(robot: Robot) -> Tree:
    """The robot's tree with a sole of its own, not yet movable, fixed to each foot at its bush.

    The foot's collision shapes move to it, and a share of its mass and inertia: together they are the foot as it was.
    """
    tree = robot.tree
    for foot in robot.feet:
        tree = _with_sole(tree, foot, bush_position(robot, foot))
    return tree


def _with_sole(tree: Tree, foot: str, bush: Array) -> Tree:
    owner, point = next((k, at) for k, link in enumerate(tree.links) for name, at in link.sites if name == foot)
    place = point * pin.SE3(np.eye(3), bush)
    in_owner = {owner: pin.SE3.Identity()}  # and the links that are fixed to it
    for k, link in enumerate(tree.links):
        if k != owner and tree.owners[k] == owner:
            in_owner[k] = in_owner[link.parent] * link.placement
    solids = [solid.moved(place.actInv(at)) for k, at in in_owner.items() for solid in tree.links[k].solids]
    inertia = tree.links[owner].inertia

    def change(k: int, link: Link) -> Link:
        link = replace(link, solids=()) if k in in_owner else link
        return replace(link, inertia=_scaled(inertia, 1.0 - SOLE_MASS_SHARE)) if k == owner else link

    sole = Link(sole_body(foot), owner, place, (), place.actInv(_scaled(inertia, SOLE_MASS_SHARE)), tuple(solids))
    changed = tree.changed(change)
    return replace(changed, links=(*changed.links, sole))


def _scaled(inertia: pin.Inertia, share: float) -> pin.Inertia:
    return pin.Inertia(share * inertia.mass, inertia.lever, share * inertia.inertia)


def add_bushes(spec: mujoco.MjSpec, robot: Robot, compliance: FootCompliance, timestep: float) -> None:
    """Let the soles of a robot move on springs and dampers.

    MuJoCo integrates dampers implicitly, but its contacts take a sole to be as light as without: under a stiff damper
    it rattles on the floor. An implicit step under a damper b is the explicit one with the inertia h b more, and with
    that inertia as the joint's armature the contacts know of it.

    Args:
        spec: of the robot's tree with soles.
        robot: the robot.
        compliance: of its feet.
        timestep: of the physics, h [s].
    """
    hinge, slide = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
    springs = (
        ("vertical", slide, [0.0, 0.0, 1.0], compliance.vertical),
        ("roll", hinge, [1.0, 0.0, 0.0], compliance.roll),
        ("pitch", hinge, [0.0, 1.0, 0.0], compliance.pitch),
    )
    relaxation = compliance.relaxation_time(robot)
    for foot in robot.feet:
        for direction, kind, axis, stiffness in springs:
            if isfinite(stiffness):
                joint = spec.body(sole_body(foot)).add_joint(name=bush_joint(foot, direction), type=kind, axis=axis)
                joint.stiffness[0], joint.damping[0] = stiffness, relaxation * stiffness
                joint.armature = timestep * relaxation * stiffness


class Soles:
    """Where the soles of a robot are below their bushes.

    Args:
        model, data: MuJoCo's.
        robot: whose soles.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, robot: Robot) -> None:
        joints = {model.joint(k).name: k for k in range(model.njnt)}
        self._data = data
        self._deflections = np.zeros((len(robot.feet), len(BUSH_AXES)))
        names = [(k, foot, i, axis) for k, foot in enumerate(robot.feet) for i, axis in enumerate(BUSH_AXES)]
        found = [(k, i, joints[name]) for k, foot, i, axis in names if (name := bush_joint(foot, axis)) in joints]
        self._feet, self._axes = [k for k, _, _ in found], [i for _, i, _ in found]
        self._places = model.jnt_qposadr[[joint for _, _, joint in found]] if found else []

    def deflections(self) -> Array:
        """Roll, pitch [rad] and height [m] of each sole (feet, 3), a new array; 0 where it cannot move."""
        out = self._deflections.copy()
        if self._feet:
            out[self._feet, self._axes] = self._data.qpos[self._places]
        return out


def sole_bodies(model: mujoco.MjModel, feet: Sequence[str]) -> dict[str, int]:
    """Foot -> MuJoCo's number of the body that touches the floor: its sole if it has one, else the foot's own."""
    bodies = {model.body(k).name for k in range(model.nbody)}
    return {
        foot: int(model.body(sole_body(foot)).id if sole_body(foot) in bodies else model.site(foot).bodyid[0])
        for foot in feet
    }
