"""On a slope of 10 degrees: the robot stands there, bows and waves."""
# python docs/examples/11_slope.py

import numpy as np
import pinocchio as pin

from scenarios.stacks import planted_stack
from sim import World, run
from solvers import Cascade
from sot.control import Controller, Pose
from sot.motion import Motion
from sot.robots import Robot, Thing
from tasks import OperationalPoint

robot, period, BOW, WAVE = Robot.load("hrp2"), 0.002, np.eye(6)[4] * 0.5, np.array([0.1, -0.2, 0.3, 0, 0, 0])
slope = Thing.load("slope", placement=pin.SE3(pin.utils.rotate("y", np.deg2rad(-10.0)), np.array([0.0, 0.0, 0.3])))
under = dict.fromkeys(robot.feet, slope.surface("top"))
motion = Motion.standing(robot, 4.0, 1.0 / period, on=under)
stack = planted_stack(robot, motion)


def swing(point, way, rate):  # way: metres over radians (6,), there and back; rate: rad/s
    start, rest, *_ = motion.pose(point)(0.0)

    def at(t):
        share, speed = 0.5 - 0.5 * np.cos(rate * t), 0.5 * rate * np.sin(rate * t)
        place = start + share * way[:3], pin.exp3(share * way[3:]) @ rest
        return Pose(*place, speed * way, (0.5 - share) * rate**2 * way)

    return at


stack.add(OperationalPoint(robot, "chest", swing("chest", BOW, 1.2), axes="P"), "bow", before="posture")
stack.add(OperationalPoint(robot, "right_hand", swing("right_hand", WAVE, 3.0), axes="xyz"), "wave", before="posture")
done = run(Controller(robot, stack, Cascade(), period), World(robot, period, things=[slope]), motion)
