"""Limits of joints: what the model says, overridden by the robot file, all that neither says told at once."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sot.gravity import GRAVITY
from sot.robots.reading.tree import Hinge, Tree
from sot.robots.robot_file import DYNAMICS, RobotFile

Array = np.ndarray

UNLIMITED_RANGE = (-np.pi, np.pi)
"""Range [rad] in which a joint is danced that nothing limits; in the physics it has no end."""
EFFORT_LEVER = 10.0
"""A torque that would hold the whole robot on a lever of this length [m] is no limit."""
FOOT_FREEDOMS = 6
"""Of a foot's place and orientation, which take as many joints to hold."""
ASYMMETRY_RATIO = 0.01
"""Difference between left and right that is told, of the larger of the two."""
POSITIVE = ("velocity", "acceleration", "acceleration_hard", "effort")


def with_limits(tree: Tree, file: RobotFile) -> Tree:
    """The tree with what the robot file says of its joints' ranges, armature, damping and friction.

    Raises:
        InputError: a number is none that the joint can have.
    """
    names = [hinge.name for hinge in tree.hinges]
    given = {name: file.limit(name, names) for name in ("lower", "upper", *DYNAMICS)}
    for name in DYNAMICS:
        for joint, value in given[name].items():
            if value < 0.0:
                raise file.error(f"'limits.{name}' of joint '{joint}' is {value}: it cannot be negative")

    def change(hinge: Hinge) -> Hinge:
        lower, upper, armature, damping, friction = (
            given[name].get(hinge.name, getattr(hinge, name)) for name in ("lower", "upper", *DYNAMICS)
        )
        changed = replace(hinge, lower=lower, upper=upper, armature=armature, damping=damping, friction=friction)
        if not changed.lower < changed.upper:
            raise file.error(
                f"joint '{hinge.name}' has no room between {changed.lower:g} and {changed.upper:g} rad: "
                "give 'limits.lower' and 'limits.upper', or put it into [locked]"
            )
        return changed

    return tree.with_hinges(change)


def joint_limits(tree: Tree, file: RobotFile, remarks: list[str]) -> dict[str, Array]:
    """Limits by name, each (na,): lower, upper, velocity, acceleration, acceleration_hard, effort.

    Args:
        tree: with its own limits, as `with_limits` returns it.
        file: of the robot.
        remarks: what is assumed is added to these.

    Raises:
        InputError: some limits are in neither file, or are not positive; all of them are named at once.
    """
    hinges = list(tree.hinges)
    names = [hinge.name for hinge in hinges]
    lower, upper = (np.array([getattr(hinge, end) for hinge in hinges]) for end in ("lower", "upper"))
    unlimited = ~np.isfinite(lower) | ~np.isfinite(upper)
    if unlimited.any():
        which = ", ".join(name for name, free in zip(names, unlimited, strict=True) if free)
        remarks.append(f"joints without a range turn by half a turn either way at most: {which}")
    lower, upper = np.where(unlimited, UNLIMITED_RANGE[0], lower), np.where(unlimited, UNLIMITED_RANGE[1], upper)
    weight = GRAVITY * sum(link.inertia.mass for link in tree.links)
    efforts = np.array([hinge.effort for hinge in hinges])
    model = {
        "velocity": np.array([hinge.velocity for hinge in hinges]),
        "effort": np.where(efforts < EFFORT_LEVER * weight, efforts, np.inf),
    }
    limits, missing, wrong = {"lower": lower, "upper": upper}, [], []
    for name in POSITIVE:
        values = model.get(name, np.full(len(names), np.inf)).copy()
        for joint, value in file.limit(name, names).items():
            values[names.index(joint)] = value
        missing += _told(name, names, values == np.inf)
        wrong += _told(name, names, ~(values > 0.0))
        limits[name] = values
    if missing:
        raise file.error(f"[limits] lacks {'; '.join(missing)}: one number for all joints will do, or a table by joint")
    if wrong:
        raise file.error(f"[limits] are not positive: {'; '.join(wrong)}")
    return limits


def _told(name: str, joints: Sequence[str], which: Array) -> list[str]:
    """A limit and some of the joints in words; nothing if there are none."""
    some = [joint for joint, one in zip(joints, which, strict=True) if one]
    return [f"'{name}' of {'all joints' if len(some) == len(joints) else ', '.join(some)}"] if some else []


def remark_on_groups(
    names: Sequence[str], limits: Mapping[str, Array], groups: Mapping[str, Sequence[int]], remarks: list[str]
) -> None:
    """Say which joints are in no group, and where left and right differ in their number, efforts or velocities."""
    grouped = {joint for group in groups.values() for joint in group}
    left_over = [name for k, name in enumerate(names) if k not in grouped]
    if left_over:
        remarks.append(f"joints in no group keep still: {', '.join(left_over)}")
    for side in ("left", "right"):
        joints = len(groups[f"{side}_leg"])
        if joints < FOOT_FREEDOMS:
            remarks.append(
                f"the {side} leg has {joints} joints: it cannot hold a flat foot in place under a moving body"
            )
    for limb in ("leg", "arm"):
        left, right = groups[f"left_{limb}"], groups[f"right_{limb}"]
        if len(left) != len(right):
            remarks.append(f"the left {limb} has {len(left)} joints, the right one {len(right)}")
            continue
        for name in ("effort", "velocity"):
            for a, b in zip(left, right, strict=True):
                one, other = float(limits[name][a]), float(limits[name][b])
                if abs(one - other) > ASYMMETRY_RATIO * max(one, other):
                    remarks.append(f"{name} differs: {one:g} of {names[a]}, {other:g} of {names[b]}")
