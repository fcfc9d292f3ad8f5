"""A human in the robot's size, moved over the robot's feet and onto the motion's time line."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.human.human import SIDES, Human
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.smooth import low_passed

Array = NDArray[np.float64]

DRIFT_HZ = 0.3  # slower changes of where the feet stand and face are a drift, which is taken out
STANDING_PERCENTILE = 10.0  # of the lower ankle's height: the height of a standing ankle
PELVIS_YAW_SHARE = 0.9  # of the hips' yaw range that the pelvis may use over standing feet
LEAD_IN_TIME = 1.0  # s, from rest to the first pose
TAIL_TIME = 1.0  # s, rest in the last pose


@dataclass(frozen=True)
class Build:
    """The sizes of a robot that a human is scaled to, from its rest posture.

    Attributes:
        leg, arm: lengths of both segments [m].
        breadth: distance of the shoulders [m].
        hips: middle of the hips in the waist frame (3,) [m].
        ankles: middle of the ankles in the world (3,) [m].
        turn: how far the pelvis can turn either way over planted feet [rad].
    """

    leg: float
    arm: float
    breadth: float
    hips: Array
    ankles: Array
    turn: float

    @staticmethod
    def of(robot: Robot) -> "Build":
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)

        def place(point: str) -> Array:
            return data.oMf[robot.point(point)].translation

        def length(*points: str) -> float:
            chain = [place(point) for point in points]
            return float(sum(np.linalg.norm(b - a) for a, b in itertools.pairwise(chain)))

        hips = np.mean([place(f"{side}_hip") for side in SIDES], axis=0)
        return Build(
            leg=leg_length(robot),
            arm=float(np.mean([length(*(f"{side}_{p}" for p in ("shoulder", "elbow", "wrist"))) for side in SIDES])),
            breadth=length("left_shoulder", "right_shoulder"),
            hips=data.oMf[robot.point("waist")].actInv(hips),
            ankles=np.mean([place(f"{side}_ankle") for side in SIDES], axis=0),
            turn=min(_pelvis_yaw_range(robot, robot.groups[f"{side}_leg"]) for side in SIDES),
        )


def human_over_feet(human: Human, build: Build) -> Human:
    """The human in the robot's size, turned and moved so that its feet stay near the robot's.

    Drift and turning slower than DRIFT_HZ are taken out, and the pelvis is turned into the range of the robot's hips:
    a robot with planted feet can follow none of them. Heights are above the ankles, which differ in height
    between robot and human.
    """
    ankles = np.mean([human.points[f"{side}_ankle"] for side in SIDES], axis=0)
    forward = np.sum([human.points[f"{side}_toe"] - human.points[f"{side}_ankle"] for side in SIDES], axis=0)
    feet = low_passed(np.unwrap(np.arctan2(forward[:, 1], forward[:, 0])), human.rate, DRIFT_HZ)
    pelvis = np.arctan2(human.frames["pelvis"][:, 1, 0], human.frames["pelvis"][:, 0, 0])
    twist = np.unwrap(np.angle(np.exp(1j * (pelvis - feet))))
    heading = feet + twist - np.clip(twist, -build.turn, build.turn)
    origin = low_passed(ankles[:, :2], human.rate, DRIFT_HZ)
    height = np.percentile(np.min([human.points[f"{side}_ankle"][:, 2] for side in SIDES], axis=0), STANDING_PERCENTILE)

    cosine, sine, nought = np.cos(heading), np.sin(heading), np.zeros_like(heading)
    turn = np.array([[cosine, sine, nought], [-sine, cosine, nought], [nought, nought, nought + 1.0]]).transpose(
        2, 0, 1
    )
    centre = np.column_stack([origin, np.full(human.count, height)])
    scale = build.leg / human.leg
    return replace(
        human,
        points={
            name: build.ankles + scale * np.einsum("tij,tj->ti", turn, place - centre)
            for name, place in human.points.items()
        },
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )


def human_on_time_line(human: Human, rate: float) -> Human:
    """The human resampled, its first pose held for LEAD_IN_TIME before and its last for TAIL_TIME after the clip."""
    human = human.resampled(rate)
    index = np.concatenate(
        [
            np.zeros(round(LEAD_IN_TIME * rate), int),
            np.arange(human.count),
            np.full(round(TAIL_TIME * rate), human.count - 1),
        ]
    )
    return replace(
        human,
        points={name: place[index] for name, place in human.points.items()},
        frames={body: rotation[index] for body, rotation in human.frames.items()},
        ground={foot: level[index] for foot, level in human.ground.items()},
    )


def _pelvis_yaw_range(robot: Robot, leg: Sequence[int]) -> float:
    """How far a leg's yaw joint, the one whose axis is most upright, can turn to either side of rest [rad]."""
    data = robot.model.createData()
    pin.computeJointJacobians(robot.model, data, robot.rest)
    upright = [abs(data.J[5, 6 + joint]) for joint in leg]
    joint = leg[int(np.argmax(upright))]
    rest = robot.rest[7 + joint]
    return PELVIS_YAW_SHARE * float(min(rest - robot.lower[joint], robot.upper[joint] - rest))
