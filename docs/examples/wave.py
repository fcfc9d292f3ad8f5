"""A stack of one's own: the robot dances, and in the middle of it lifts its right hand twice.

sot replay groove --stack docs/examples/wave.py
"""

import numpy as np

from sot.control import Contact, Pose, Schedule, Stack
from tasks import Balance, JointBounds, LeastForces, OperationalPoint, Posture, SelfCollision, TorqueBounds


def stack(robot, motion):
    """What the robot is asked for, most important first."""
    return Stack(
        contacts=[Contact(robot.surface(foot)) for foot in robot.feet],
        hard=[TorqueBounds(robot), JointBounds(robot), SelfCollision(robot)],
        levels={
            "balance": [Balance(motion.balance, motion.feet)],
            "waist": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="RPY")],
            "body": [
                OperationalPoint(robot, "chest", motion.pose("chest"), axes="RPY", weight=2.0),
                OperationalPoint(robot, "head", motion.pose("head"), axes="RPY"),
                Posture(robot, motion.joints),
            ],
            "forces": [LeastForces()],
        },
    )


START, WAVE, HEIGHT = 3.0, 1.5, 0.2  # s, s, m


def schedule(robot, motion):
    """What changes over time: for two waves the hand goes before the dance."""
    dancing = motion.pose("right_hand")

    def waving(t):
        phase = 2.0 * np.pi * (t - START) / WAVE
        rate = 2.0 * np.pi / WAVE
        up = np.array([0.0, 0.0, 0.5 * HEIGHT, 0.0, 0.0, 0.0])
        position, rotation, velocity, acceleration = dancing(t)
        return Pose(
            position + (1.0 - np.cos(phase)) * up[:3],
            rotation,
            velocity + rate * np.sin(phase) * up,
            acceleration + rate**2 * np.cos(phase) * up,
        )

    hand = OperationalPoint(robot, "right_hand", waving, axes="xyz", name="wave")
    return Schedule().add(START, hand, level="wave", before="body").remove(START + 2.0 * WAVE, "wave")
