"""A hand on a table: the robot leans on it, lifts a foot, and puts its centre of mass beyond the other one's sole."""
# python docs/examples/hand_support.py

import numpy as np
import pinocchio as pin

from scenarios.stacks import planted_stack
from sim import World, run
from solvers import Cascade
from sot.control import Contact, Controller, Pose, Schedule
from sot.motion import Motion
from sot.robots import Robot, Thing
from tasks import FreePoint, OperationalPoint

robot, period, PALM_DOWN = Robot.load("hrp2"), 0.002, np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
table = Thing.load("table", placement=(0.67, 0.0, 0.15))
motion = Motion.standing(robot, 14.0, 1.0 / period)
stack, plan, still = planted_stack(robot, motion), motion.balance, np.zeros(6)
(hand, hanging, *_), (foot, flat, *_) = (motion.pose(point)(0.0) for point in ("right_hand", "left_foot"))
to_palm_down = pin.log3(hanging.T @ PALM_DOWN)


def eased(t, *places):  # each place is there 1.5 s after the one before
    ways = np.diff(places, axis=0)
    shares = 0.5 - 0.5 * np.cos(np.pi * np.clip(t / 1.5 - np.arange(len(ways)), 0.0, 1.0))
    return places[0] + shares @ ways


def reach(t):
    place = eased(t, hand, (0.2, -0.4, 0.95), (0.45, -0.3, 0.93), (0.45, -0.3, 0.903))
    turn = eased(t, np.zeros(3), 0.5 * to_palm_down, to_palm_down)
    return Pose(place, hanging @ pin.exp3(turn), still, still)


def lean(t):
    com, *_, zmp = plan(t)
    ahead = eased(t - 6.0, np.zeros(3), np.array([0.1, -0.05, 0.0]), np.array([0.145, -0.09, 0.0]))
    return com + ahead, still[:3], still[:3], zmp + ahead[:2]


def lift(t):
    return Pose(eased(t - 10.0, foot, foot + np.array([0.0, 0.0, 0.05])), flat, still, still)


palm = Contact(robot.surface("right_palm"), table.surface("top"), axes="xyz", least=5.0, most=250.0, reserve=3.0)
palm.mode, palm.load = "off", 0.0  # until the hand is there
stack.contacts.append(palm)
stack.task("Balance").reference = lean
stack.add(OperationalPoint(robot, "right_hand", reach, kp=60.0, weight=100.0), "hand", before="posture")
stack.add(FreePoint(robot, "left_foot", lift, kp=100.0), "foot", before="waist")
schedule = Schedule().mode(5.0, palm.name, "fixed", ramp=0.4).mode(10.0, "left_foot", "off", ramp=0.4)
done = run(Controller(robot, stack, Cascade(), period, schedule), World(robot, period, things=[table]), motion)
log = done.log.trimmed()
edge = motion.pose("right_foot")(0.0)[0][0] + robot.sole("right_foot")[:, 0].max()
force = log.contact_normal[-1, log.contact_names.index(palm.name)]
print(f"centre of mass {1e3 * (log.com[-1, 0] - edge):.0f} mm beyond the sole, {force:.0f} N on the hand")
