"""Targets of the robot's body at every knot: a human's directions and frames, eased in from the rest posture."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.motion.body.lean import with_leans_in_range
from sot.motion.feet.stance import LEAD_IN_TIME, Build
from sot.motion.human.human import SEGMENTS, SIDES, Human
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

UPPER_BODY_SEGMENTS = ("trunk", "head", *(f"{side}_{part}" for side in SIDES for part in ("upper_arm", "forearm")))


@dataclass(frozen=True)
class Targets:
    """Targets at T knots, in the robot's world.

    Attributes:
        hips: (T, 3) middle of the hips [m].
        frames: pelvis, chest, head -> (T, 3, 3).
        directions: segment -> (T, 3) unit vectors.
        height: error of the hips' height that is accepted [m]; None for what goes with the feet, and hips that are
            lowered smoothly to where both legs reach.
        lean_cut: (T,) how much less the trunk leans than the human's [rad].
        extension: foot -> (T,) share of its length to which the human's leg is extended.
    """

    hips: Array
    frames: dict[str, Array]
    directions: dict[str, Array]
    lean_cut: Array
    extension: dict[str, Array]
    height: float | None = None

    @property
    def length(self) -> int:
        return len(self.hips)


def targets_of_human(
    human: Human, robot: Robot, build: Build, facing: Array, moved: tuple[float, float] = (0.0, 0.0)
) -> Targets:
    """Targets from a human that stands over the robot's feet, on the motion's time line, eased in within LEAD_IN_TIME
    from the rest posture over the feet of the first knot.

    The trunk leans no farther than legs and waist do, see `lean.with_leans_in_range`.

    Args:
        human: of T frames.
        robot: whose targets they are.
        build: of the robot.
        facing: (T,) heading of the feet, from which the chest is turned [rad].
        moved: x and y of the middle of the feet at the first knot, from where it is at rest [m].
    """
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    lead = minimum_jerk(np.arange(human.count) / human.rate / LEAD_IN_TIME)[:, None]

    middle = np.mean([data.oMf[robot.point(foot)].translation for foot in robot.feet], axis=0)
    turned = pin.utils.rotate("z", float(facing[0]))

    def at_start(point: str) -> Array:
        return middle + turned @ (data.oMf[robot.point(point)].translation - middle) + np.array([*moved, 0.0])

    directions = {}
    for segment in UPPER_BODY_SEGMENTS:
        near, far = SEGMENTS[segment]
        rest = at_start(far) - at_start(near)
        mixed = (1.0 - lead) * rest / np.linalg.norm(rest) + lead * human.segment_direction(segment)
        directions[segment] = mixed / np.linalg.norm(mixed, axis=1, keepdims=True)

    hips_at_rest = data.oMf[robot.point("waist")].rotation @ build.hips
    hips = (1.0 - lead) * (at_start("waist") + turned @ hips_at_rest) + lead * human.points["waist"]
    human_breadth = np.median(np.linalg.norm(human.points["left_shoulder"] - human.points["right_shoulder"], axis=1))
    swing = min(1.0, (human_breadth / human.arm) / (build.breadth / build.arm))
    frames = {}
    for body, rotation in (human.frames | {"chest": _with_share_of_yaw(human.frames["chest"], swing, facing)}).items():
        turn = Rotation.from_matrix(turned.T @ rotation).as_rotvec()
        frames[body] = turned @ Rotation.from_rotvec(lead * turn).as_matrix()
    frames, directions, lean_cut = with_leans_in_range(robot, frames, directions, facing)
    return Targets(hips, frames, directions, lean_cut, {f"{side}_foot": leg_extension(human, side) for side in SIDES})


def leg_extension(human: Human, side: str) -> Array:
    """The distance from hip to ankle (T,), over the length of thigh and shank."""
    hip, knee, ankle = (human.points[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle"))
    length = np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1)
    extension: Array = np.linalg.norm(ankle - hip, axis=1) / length
    return extension


def key_points(wanted: Targets, robot: Robot) -> dict[str, Array]:
    """Positions of neck, top of the head, elbows and wrists if every target is met: point -> (T, 3) from the waist [m].

    This is the human in the robot's size, limb by limb: each segment has the robot's length and the human's direction,
    and shoulders and head sit on the chest as the robot's do at rest.
    """
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)

    def between(near: str, far: str) -> Array:
        return data.oMf[robot.point(far)].translation - data.oMf[robot.point(near)].translation

    def on_chest(near: str, far: str) -> Array:
        return wanted.frames["chest"] @ data.oMf[robot.point("chest")].rotation.T @ between(near, far)

    def along(segment: str) -> Array:
        return np.linalg.norm(between(*SEGMENTS[segment])) * wanted.directions[segment]

    neck = along("trunk")
    points = {"neck": neck, "head_top": neck + on_chest("neck", "head") + along("head")}
    for side in SIDES:
        elbow = neck + on_chest("neck", f"{side}_shoulder") + along(f"{side}_upper_arm")
        points |= {f"{side}_elbow": elbow, f"{side}_wrist": elbow + along(f"{side}_forearm")}
    return points


def _with_share_of_yaw(rotations: Array, share: float, facing: Array) -> Array:
    """Orientations (T, 3, 3) with a share of their turn from a heading (T,): Z(share · yaw) in place of Z(yaw)."""
    yaw = np.unwrap(np.arctan2(rotations[:, 1, 0], rotations[:, 0, 0]) - facing)
    yaw -= 2.0 * np.pi * np.round(np.median(yaw) / (2.0 * np.pi))
    return Rotation.from_euler("Z", (share - 1.0) * yaw[:, None]).as_matrix() @ rotations
