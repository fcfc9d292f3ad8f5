"""Whether a robot file's sides, groups and limits fit the body that they describe."""

from collections.abc import Iterator, Mapping

import numpy as np
import pinocchio as pin

from scenarios.robots.findings import Finding, Severity
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.robots.robot_file import SIDED
from sot.robots.size import leg_length

MAX_LEG_EXTENSION = 0.985  # share of its length beyond which a leg cannot push
MIN_EFFORT_SHARE, USUAL_EFFORT_SHARES = (
    0.05,
    (0.2, 0.6),
)  # efforts of a leg's joints, as shares of weight times leg length: little, and usual

REMEDIES: Mapping[str, tuple[Severity, str]] = {
    "cannot hold a flat foot": (Severity.STOPS, "none: six joints a leg are needed to dance; others walk on lines"),
    "joints in no group": (Severity.WARNS, "put them into a group, or into [locked] if they are not to move"),
    "springs": (Severity.WARNS, "expect torques that are too large or too small there"),
    "couplings": (Severity.WARNS, "put the joints that follow into [locked]; parallel mechanisms become their joints"),
    "tendons": (Severity.WARNS, "motors act on joints instead"),
    "reaches": (Severity.WARNS, "take the corners back: the robot tips where it counts on a sole that is not there"),
    "lowest of its shapes": (Severity.WARNS, "put the foot's point on the lowest of its shapes"),
    "differs": (Severity.WARNS, "correct one of them, unless the robot is built so"),
    "nothing keeps from": (Severity.WARNS, "give the links shapes that collide"),
    "no shape that collides": (Severity.WARNS, "give the foot a shape, if it is not flat as its sole is"),
    "without a range": (Severity.WARNS, "give 'limits.lower' and 'limits.upper'"),
}
"""What to do about a remark of the loading that has these words in it; others need nothing to be done."""


def remark_findings(robot: Robot) -> Iterator[Finding]:
    """What loading had to say."""
    for remark in robot.remarks:
        told = next((found for words, found in REMEDIES.items() if words in remark), None)
        severity, remedy = told or (Severity.NOTES, "nothing, if the model is meant so")
        yield Finding(severity, remark, robot.path.name, remedy)


def part_findings(robot: Robot) -> Iterator[Finding]:
    """Points on the wrong side, groups that do not move their limb, straight legs, and weak motors."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    place = {name: data.oMf[frame].translation for name, frame in robot.points.items()}
    yield from _sides(robot, place)
    yield from _groups(robot)
    yield from _legs(robot, place)
    leg = leg_length(robot)
    strength = robot.mass * GRAVITY * leg
    weak = [
        f"{robot.joints[k]} {robot.effort[k]:g} N m"
        for k in robot.groups["legs"]
        if robot.effort[k] < MIN_EFFORT_SHARE * strength
    ]
    if weak:
        what = f"efforts of the legs are little for {robot.mass:.0f} kg on legs of {leg:.2f} m"
        low, high = (share * strength for share in USUAL_EFFORT_SHARES)
        remedy = f"correct 'limits.effort': humanoids have {low:.0f} to {high:.0f} N m there"
        yield Finding(Severity.WARNS, what, ", ".join(weak), remedy)


def _sides(robot: Robot, place: Mapping[str, np.ndarray]) -> Iterator[Finding]:
    swapped = [
        f"{side}_{point}"
        for side, sign in (("left", 1.0), ("right", -1.0))
        for point in SIDED
        if sign * place[f"{side}_{point}"][1] < 0.0
    ]
    if swapped:
        yield Finding(Severity.STOPS, "points are on the other side", ", ".join(swapped), "left is +y: swap them")


def _groups(robot: Robot) -> Iterator[Finding]:
    """Leg groups with joints that do not move the foot, arm groups with none that moves the wrist."""
    for side in ("left", "right"):
        for group, end in (("leg", "foot"), ("arm", "wrist")):
            frame = robot.model.frames[robot.point(f"{side}_{end}")]
            moving = {robot.model.names[j] for j in robot.model.supports[frame.parentJoint].tolist()}
            joints = [robot.joints[k] for k in robot.groups[f"{side}_{group}"]]
            idle = [joint for joint in joints if joint not in moving]
            if idle and (group == "leg" or len(idle) == len(joints)):
                what = f"joints of the group do not move {side}_{end}"
                remedy = f"groups.{side}_{group} takes the joints between the trunk and that point: are sides swapped?"
                yield Finding(Severity.STOPS, what, ", ".join(idle), remedy)


def _legs(robot: Robot, place: Mapping[str, np.ndarray]) -> Iterator[Finding]:
    for side in ("left", "right"):
        hip, knee, ankle = (place[f"{side}_{name}"] for name in ("hip", "knee", "ankle"))
        length = float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))
        if np.linalg.norm(ankle - hip) > MAX_LEG_EXTENSION * length:
            what = "the leg is straight at rest: it cannot push, and there is no room to extend it"
            yield Finding(Severity.STOPS, what, f"rest, {side} knee", "bend the knees by about 0.7 rad")
