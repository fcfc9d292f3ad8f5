"""A hand on a wall: it reaches for it, leans on it with 40 N, and lets go."""
# python docs/examples/12_wall.py

import pinocchio as pin

from scenarios.stacks import planted_stack
from sim import World, run
from solvers import Cascade
from sot.control import Contact, Controller, Schedule
from sot.motion import Motion
from sot.robots import Robot, Thing
from tasks import OperationalPoint

robot, period = Robot.load("hrp2"), 0.002
wall = Thing.load("wall", placement=(0.5, 0.0, 0.0))
motion = Motion.standing(robot, 5.0, 1.0 / period)
stack, there = planted_stack(robot, motion), pin.XYZQUATToSE3([0.382, -0.25, 0.95, 0.0, -0.7071, 0.0, 0.7071])
reach = OperationalPoint(robot, "right_hand", there, kp=16.0, weight=100.0, name="reach")
lean = Contact(robot.surface("right_hand_end"), wall.surface("front"), least=40.0, most=60.0)
lean.mode, lean.load = "off", 0.0  # until the hand is there
stack.contacts.append(lean)
schedule = Schedule().add(0.0, reach, "posture", ramp=1.0).mode(3.0, lean.name, "fixed", ramp=0.4)
schedule.mode(4.5, lean.name, "off", ramp=0.4)
done = run(Controller(robot, stack, Cascade(), period, schedule), World(robot, period, things=[wall]), motion)
