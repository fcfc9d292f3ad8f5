"""A task of one's own: the right hand at a given place as seen from the left one."""
# python docs/examples/02_own_task.py

import numpy as np

from scenarios.stacks import planted_stack
from sim import World, run
from solvers import Cascade
from sot.control import Controller, MotionTask
from sot.motion import Motion
from sot.robots import Robot


class HandToHand(MotionTask):
    """Error, its rate, Jacobian, drift J̇ v and feed-forward of what is observed."""

    def observe(self, tick):
        right, left = tick.frame("right_hand"), tick.frame("left_hand")
        error = WANTED - (right.position - left.position)
        rate = -(right.velocity - left.velocity)[:3]
        return error, rate, (right.jacobian - left.jacobian)[:3], (right.drift - left.drift)[:3], np.zeros(3)


WANTED = np.array([0.1, -0.3, 0.1])  # m, in the world's axes
robot = Robot.load("hrp2")
motion = Motion.standing(robot, 2.0, 500.0)
stack = planted_stack(robot, motion)
stack.add(HandToHand("hand to hand", unit="m/s²", error_unit="m", kp=100.0), "hands", before="posture")
done = run(Controller(robot, stack, Cascade(), 0.002), World(robot, 0.002), motion)
