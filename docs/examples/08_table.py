"""A scenario of one's own, with a table in it: recorded and reported as all others are."""
# sot run docs/examples/08_table.py

import mujoco
import numpy as np

from scenarios import Scenario
from scenarios.stacks import planted_stack
from sot.control import Pose
from sot.motion import Motion
from tasks import OperationalPoint

UP, RATE = np.array([0.05, 0.0, 0.15, 0.0, 0.0, 0.0]), np.pi  # m, rad/s


def table(spec):
    spec.worldbody.add_geom(name="table", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.4, 0.02], pos=[0.65, 0, 0.6])


def scenario(robot, rate):
    """What `sot run` runs: reach up over the table, twice."""
    motion = Motion.standing(robot, 4.0, rate)
    start, rest, *_ = motion.pose("right_hand")(0.0)

    def reach(t):
        share, speed, change = 0.5 * (1.0 - np.cos(RATE * t)), np.sin(RATE * t), np.cos(RATE * t)
        return Pose(start + share * UP[:3], rest, 0.5 * RATE * speed * UP, 0.5 * RATE**2 * change * UP)

    stack = planted_stack(robot, motion)
    stack.add(OperationalPoint(robot, "right_hand", reach, axes="xyz"), "hand", before="posture")
    return Scenario(motion, stack, scene=table)
