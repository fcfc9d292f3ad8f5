"""A slope of 10 degrees: the robot walks up by a metre, and down again."""
# python docs/examples/14_slope_walk.py

import numpy as np
import pinocchio as pin

from scenarios.stacks import stepping_schedule, stepping_stack
from sim import World, run
from solvers import Cascade
from sot.control import Controller
from sot.motion import walk
from sot.robots import Robot, Thing

robot, period, WAY = Robot.load("hrp2"), 0.002, 1.0
slope = Thing.load("slope", placement=pin.SE3(pin.utils.rotate("y", np.deg2rad(-10.0)), np.array([0.5, 0.0, 0.4])))
motion = walk(robot, [WAY, -WAY], 1.0 / period, ground=slope.surface("top"))
stack = stepping_stack(robot, motion)
controller = Controller(robot, stack, Cascade(), period, stepping_schedule(robot, motion))
done = run(controller, World(robot, period, things=[slope]), motion)
