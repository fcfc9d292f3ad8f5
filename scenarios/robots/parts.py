"""Whether a robot file's sides, groups and limits fit the body that they describe."""

from collections.abc import Iterator

import mujoco
import numpy as np
import pinocchio as pin

from scenarios.robots.findings import Finding, Severity
from sot.robots.guess.tree import Tree
from sot.robots.robot import SIDED, Robot

LEG_JOINTS = 6  # that hold a foot in place and orientation under a body that moves
STRAIGHT = 0.985  # share of its length beyond which a leg cannot push
WEAK = 0.05  # share of weight times leg length that is little for a hip, a knee or an ankle
GRAVITY = 9.81  # m/s²
TOE_SHARE = 0.04  # share of a sole's length by which its middle may be behind the ankle


def part_findings(robot: Robot) -> Iterator[Finding]:
    """Sides that are swapped, legs with too few joints, joints in no group or without room, and weak motors."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    place = {name: data.oMf[frame].translation for name, frame in robot.points.items()}
    yield from _sides(robot, place)
    yield from _legs(robot, place)
    yield from _joints(robot)
    leg = float(np.linalg.norm(place["left_hip"] - place["left_ankle"]))
    strength = robot.mass * GRAVITY * leg
    weak = [
        f"{robot.joints[k]} {robot.effort[k]:g} N m" for k in robot.groups["legs"] if robot.effort[k] < WEAK * strength
    ]
    if weak:
        what = f"efforts of the legs are little for {robot.mass:.0f} kg on legs of {leg:.2f} m"
        remedy = f"correct 'limits.effort': humanoids have {0.2 * strength:.0f} to {0.6 * strength:.0f} N m there"
        yield Finding(Severity.WARNS, what, ", ".join(weak), remedy)


def feature_findings(original: Tree) -> Iterator[Finding]:
    """What a model has and the robot will not: springs, couplings, tendons."""
    model = original.model
    springs = [original.joint_name(j) for j in original.joints if np.any(model.jnt_stiffness[j])]
    if springs:
        remedy = "they are left out in the controller's model: expect a torque too much or too little there"
        yield Finding(Severity.WARNS, "springs are not modelled", ", ".join(springs), remedy)
    kinds = {
        mujoco.mjtEq.mjEQ_JOINT: "couplings of joints",
        mujoco.mjtEq.mjEQ_CONNECT: "closed chains",
        mujoco.mjtEq.mjEQ_WELD: "welds",
        mujoco.mjtEq.mjEQ_TENDON: "couplings of tendons",
    }
    for kind, words in kinds.items():
        count = int(np.sum(model.eq_type == kind)) if model.neq else 0
        if count:
            remedy = "lock the joints that follow in [locked]; parallel mechanisms become their joints"
            yield Finding(Severity.WARNS, f"{words} are not modelled", f"{count} in the model", remedy)
    if model.ntendon:
        where = f"{model.ntendon} in the model"
        yield Finding(Severity.WARNS, "tendons are not modelled", where, "motors act on joints instead")


def _sides(robot: Robot, place: dict[str, np.ndarray]) -> Iterator[Finding]:
    swapped = [
        f"{side}_{point}"
        for side, sign in (("left", 1.0), ("right", -1.0))
        for point in SIDED
        if sign * place[f"{side}_{point}"][1] < 0.0
    ]
    if swapped:
        remedy = "swap left and right, or turn the model: left is +y, and it looks along x"
        yield Finding(Severity.STOPS, "points are on the other side", ", ".join(swapped), remedy)
    for side in ("left", "right"):
        for group, end in (("leg", "foot"), ("arm", "wrist")):
            frame = robot.model.frames[robot.point(f"{side}_{end}")]
            moving = {robot.model.names[j] for j in robot.model.supports[frame.parentJoint].tolist()[2:]}
            joints = [robot.joints[k] for k in robot.groups[f"{side}_{group}"]]
            idle = [joint for joint in joints if joint not in moving]
            beyond = {"leg": idle, "arm": idle if len(idle) == len(joints) else []}[group]
            if beyond:
                what = f"joints of the group do not move {side}_{end}"
                remedy = f"put only the joints between trunk and {end} into groups.{side}_{group}"
                yield Finding(Severity.STOPS, what, ", ".join(beyond), remedy)
    for foot in robot.feet:
        side = foot.split("_")[0]
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        along = np.array([data.oMf[robot.point(foot)].act(corner)[0] for corner in robot.sole(foot)])
        ahead = 0.5 * (along.min() + along.max()) - place[f"{side}_ankle"][0]
        if ahead < -TOE_SHARE * np.ptp(along):
            what = f"the sole's middle is {1e3 * -ahead:.0f} mm behind the ankle: the robot seems to look backwards"
            yield Finding(Severity.WARNS, what, foot, "turn the model, so that it looks along x")
            return


def _legs(robot: Robot, place: dict[str, np.ndarray]) -> Iterator[Finding]:
    for side in ("left", "right"):
        joints = robot.groups[f"{side}_leg"]
        if len(joints) < LEG_JOINTS:
            what = f"the leg has {len(joints)} joints: it cannot hold a flat foot in place under a body that moves"
            remedy = "none: such robots walk on point or line feet, which are not planned here"
            yield Finding(Severity.STOPS, what, f"groups.{side}_leg", remedy)
        hip, knee, ankle = (place[f"{side}_{name}"] for name in ("hip", "knee", "ankle"))
        length = float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))
        if np.linalg.norm(ankle - hip) > STRAIGHT * length:
            what = "the leg is straight at rest: it cannot push, nor is there a way down"
            yield Finding(Severity.STOPS, what, f"rest, {side} knee", "bend the knees by about 0.7 rad")


def _joints(robot: Robot) -> Iterator[Finding]:
    grouped = {k for joints in robot.groups.values() for k in joints}
    left = [name for k, name in enumerate(robot.joints) if k not in grouped]
    if left:
        remedy = "put them into a group, or, if they do not move in a dance, into [locked]"
        yield Finding(Severity.WARNS, "joints are in no group", ", ".join(left), remedy)
    angles = zip(robot.joints, robot.rest[7:], robot.lower, robot.upper, strict=True)
    outside = [name for name, angle, low, high in angles if not low <= angle <= high]
    if outside:
        yield Finding(Severity.STOPS, "the rest posture is out of range", ", ".join(outside), "correct 'rest'")
