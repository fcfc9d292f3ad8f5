"""Limits of the coordinates y that motions are fitted in, a little inside the robot's own."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.human import SIDES
from sot.robot import Robot

Array = NDArray[np.float64]

ROOM = 0.02  # rad, kept free at either end of a joint's range for the closed loop
SHARE = 0.97  # of the velocity and acceleration limits that a reference may use
STRAIGHT = 0.985  # of its length that a leg may extend to: at full length it can no longer push


@dataclass(frozen=True)
class Limits:
    """lower, upper, velocity, acceleration (nv,) of y; infinite for the base."""

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array

    @staticmethod
    def of(robot: Robot) -> "Limits":
        rest = robot.rest[7:]
        base = np.full(6, np.inf)
        lower = np.minimum(robot.lower + ROOM, rest - ROOM)
        upper = np.maximum(robot.upper - ROOM, rest + ROOM)
        _keep_knees_bent(robot, lower, upper)
        return Limits(
            np.concatenate([-base, lower]),
            np.concatenate([base, upper]),
            np.concatenate([base, SHARE * robot.velocity]),
            np.concatenate([base, SHARE * robot.acceleration]),
        )


def _keep_knees_bent(robot: Robot, lower: Array, upper: Array) -> None:
    """Bound the joint that sets each leg's length, found by trying, where the leg gets nearly straight."""
    data = robot.model.createData()

    def extension(side: str, joint: int, angle: float) -> float:
        q = robot.rest.copy()
        q[7 + joint] = angle
        pin.framesForwardKinematics(robot.model, data, q)
        hip, knee, ankle = (data.oMf[robot.point(f"{side}_{p}")].translation for p in ("hip", "knee", "ankle"))
        return float(np.linalg.norm(ankle - hip) / (np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee)))

    for side in SIDES:
        joints = robot.groups[f"{side}_leg"]
        rest = robot.rest[7:]
        bends = [extension(side, j, rest[j] + 0.1) - extension(side, j, rest[j] - 0.1) for j in joints]
        knee = joints[int(np.argmax(np.abs(bends)))]
        for bound in (lower, upper):
            angles = np.linspace(rest[knee], bound[knee], 200)
            bent = [extension(side, knee, angle) <= STRAIGHT for angle in angles]
            if not all(bent):
                bound[knee] = angles[max(1, bent.index(False)) - 1]
