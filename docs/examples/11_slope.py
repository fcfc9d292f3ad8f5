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

robot, period, seconds = Robot.load("hrp2"), 0.002, 20.0
tilt = pin.SE3(pin.rpy.rpyToMatrix(0.0, np.deg2rad(-10.0), 0.0), np.array([0.0, 0.0, 0.3]))
slope = Thing.load("slope", placement=tilt)
under = dict.fromkeys(robot.feet, slope.surface("top"))
motion = Motion.standing(robot, seconds, 1.0 / period, on=under)


def swing(point, way, rate):  # way: metres over radians (6,), there and back; rate: rad/s
    start, rest, *_ = motion.pose(point)(0.0)

    def at(t):
        share, speed, change = 0.5 * (1 - np.cos(rate * t)), 0.5 * np.sin(rate * t), 0.5 * np.cos(rate * t)
        turn = pin.exp3(share * way[3:]) @ rest
        return Pose(start + share * way[:3], turn, rate * speed * way, rate**2 * change * way)

    return at


stack = planted_stack(robot, motion, on=under)
bow, wave = np.array([0, 0, 0, 0, 0.5, 0.0]), np.array([0.1, -0.2, 0.3, 0, 0, 0])
stack.add(OperationalPoint(robot, "chest", swing("chest", bow, 1.2), axes="P"), "bow", before="posture")
stack.add(OperationalPoint(robot, "right_hand", swing("right_hand", wave, 3.0), axes="xyz"), "wave", before="posture")
done = run(Controller(robot, stack, Cascade(), period), World(robot, period, things=[slope]), motion)
