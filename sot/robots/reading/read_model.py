"""The one way in: any MJCF or URDF becomes a tree of numbers, and from it one MuJoCo and one Pinocchio model."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import mujoco
import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.reading.agreement import mujoco_reading, pinocchio_reading, refuse_difference, seeded_poses
from sot.robots.reading.mjcf import KeyFrame, find_robot
from sot.robots.reading.mjcf_file import compile_mjcf
from sot.robots.reading.pinocchio_model import pinocchio_model
from sot.robots.reading.tree import Tree
from sot.robots.reading.urdf import read_urdf

NOTHING: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class ModelReading:
    """What a model file says of a robot, cleaned: the robot's own tree, and nothing else of the file's scene.

    Attributes:
        tree: links, joints, masses, shapes and sites, as numbers.
        compiled: MuJoCo's model of the tree, the robot alone on a free base, its joints all hinges.
        model: Pinocchio's model of the same, joints in the same order.
        key_frames: postures that the file names.
        remarks: what was mended, left out or is not modelled, a sentence each.
    """

    tree: Tree
    compiled: mujoco.MjModel = field(repr=False)
    model: pin.Model = field(repr=False)
    key_frames: Mapping[str, KeyFrame] = field(repr=False)
    remarks: tuple[str, ...]


def read_model(path: Path, locked: Mapping[str, float] = NOTHING) -> ModelReading:
    """Read a robot from an MJCF or a URDF (`.urdf`), whose own reader's view is compared with what comes out.

    Args:
        path: of the model file.
        locked: joints that are held, with their angles [rad] or places [m]; they become part of what carries them.

    Raises:
        InputError: the file cannot be read, is no robot on a free base whose other joints turn about one axis each, or
            MuJoCo and Pinocchio do not agree on it.
    """
    remarks: list[str] = []
    if path.suffix.lower() == ".urdf":
        theirs, tree = read_urdf(path, locked, remarks)
        compiled, model = models_of(tree, path)
        names = [hinge.name for hinge in tree.hinges]
        for angles in _poses(tree):
            ours = pinocchio_reading(model, names, angles)
            refuse_difference(path, ours, pinocchio_reading(theirs, names, angles))
        return ModelReading(tree, compiled, model, {}, tuple(remarks))
    whole = compile_mjcf(path, remarks)
    found = find_robot(whole, path, locked, remarks)
    compiled, model = models_of(found.tree, path)
    names = [hinge.name for hinge in found.tree.hinges]
    numbers = [found.joints[name] for name in names]
    held = {found.joints[name]: angle for name, angle in locked.items()}
    for angles in _poses(found.tree):
        ours = pinocchio_reading(model, names, angles)
        refuse_difference(path, ours, mujoco_reading(whole, found.base, numbers, held, angles))
    return ModelReading(found.tree, compiled, model, found.key_frames, tuple(remarks))


def models_of(tree: Tree, path: Path, rest: np.ndarray | None = None) -> tuple[mujoco.MjModel, pin.Model]:
    """MuJoCo's and Pinocchio's model of a tree.

    Args:
        tree: the robot.
        path: of the file it comes from, for messages.
        rest: angles (na,) [rad] at which, and at some random ones, the two are compared; zero unless given.

    Raises:
        InputError: MuJoCo refuses a number in it, or the two do not agree.
    """
    try:
        compiled = tree.spec().compile()
    except (ValueError, mujoco.FatalError) as error:
        raise InputError(f"{path}: MuJoCo refuses it: {'; '.join(str(error).split(chr(10)))}") from None
    model = pinocchio_model(compiled)
    names = [hinge.name for hinge in tree.hinges]
    for angles in _poses(tree, rest):
        theirs = mujoco_reading(compiled, 1, range(1, compiled.njnt), {}, angles)
        refuse_difference(path, pinocchio_reading(model, names, angles), theirs)
    return compiled, model


def _poses(tree: Tree, rest: np.ndarray | None = None) -> list[np.ndarray]:
    lower, upper = (np.array([getattr(hinge, end) for hinge in tree.hinges]) for end in ("lower", "upper"))
    return seeded_poses(lower, upper, np.zeros(len(lower)) if rest is None else rest)
