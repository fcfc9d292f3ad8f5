"""Limits of the fitted coordinates y, a little inside the robot's own."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.acceleration_bounds import SOFT_BRAKING_RANGE
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = NDArray[np.float64]

RANGE_MARGIN = 0.02  # rad, kept free at both ends of a joint's range for the closed loop
LEG_RANGE_MARGIN = RANGE_MARGIN + SOFT_BRAKING_RANGE
"""Of the legs [rad]. Where the controller brakes gently, it would hold a standing leg back from its plan, and the arms
would swing to keep the pelvis where it should be."""
USABLE_LIMIT_SHARE = 0.97  # share of the velocity and acceleration limits that a reference may use
LEG_VELOCITY_SHARE = 0.92  # the same share of the legs' velocity limits: feedback needs the rest
MAX_LEG_EXTENSION = 0.985  # share of its length that a leg may extend to: at full length it can no longer push
MAX_LEG_EXTENSION_STEPPING = 0.995  # the same where feet step and none slides


@dataclass(frozen=True)
class Limits:
    """Limits lower, upper, velocity and acceleration (nv,) of the coordinates y; infinite for the base."""

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array

    @staticmethod
    def of(robot: Robot, extension: float = MAX_LEG_EXTENSION) -> "Limits":
        """extension: share of its length that a leg may extend to."""
        rest = robot.rest[7:]
        base = np.full(6, np.inf)
        margin, share = np.full(robot.na, RANGE_MARGIN), np.full(robot.na, USABLE_LIMIT_SHARE)
        legs = list(robot.groups["legs"])
        margin[legs], share[legs] = LEG_RANGE_MARGIN, LEG_VELOCITY_SHARE
        lower = np.minimum(robot.lower + margin, rest - margin)
        upper = np.maximum(robot.upper - margin, rest + margin)
        _keep_knees_bent(robot, lower, upper, extension)
        return Limits(
            np.concatenate([-base, lower]),
            np.concatenate([base, upper]),
            np.concatenate([base, share * robot.velocity]),
            np.concatenate([base, USABLE_LIMIT_SHARE * robot.acceleration]),
        )


def _keep_knees_bent(robot: Robot, lower: Array, upper: Array, most: float) -> None:
    """Bound the joint that sets each leg's length where the leg gets nearly straight; trials find the joint."""
    chains, rest = JointTree(robot), robot.rest[7:]

    def extension(side: str, joint: int, angles: Array) -> Array:
        y = np.tile(from_configuration(robot.rest[None]), (len(angles), 1))
        y[:, 6 + joint] = angles
        kinematics = Kinematics(chains, y)
        hip, knee, ankle = (kinematics.frame_pose(robot.point(f"{side}_{p}"))[1] for p in ("hip", "knee", "ankle"))
        reach, thigh, shank = (np.linalg.norm(b - a, axis=1) for a, b in ((hip, ankle), (hip, knee), (knee, ankle)))
        return reach / (thigh + shank)

    for side in SIDES:
        joints = robot.groups[f"{side}_leg"]
        bends = [np.ptp(extension(side, j, rest[j] + np.array([-0.1, 0.1]))) for j in joints]
        knee = joints[int(np.argmax(bends))]
        for bound in (lower, upper):
            angles = np.linspace(rest[knee], bound[knee], 200)
            bent = extension(side, knee, angles) <= most
            if not bent.all():
                bound[knee] = angles[max(1, int(bent.argmin())) - 1]
