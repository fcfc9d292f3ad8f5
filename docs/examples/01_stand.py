"""The robot stands: what moves, what it is asked for, where, and the loop over it."""
# python docs/examples/01_stand.py

from sim import World
from solvers import Cascade
from sot.control import Contact, Controller, Stack
from sot.motion import Motion
from sot.robots import Robot
from tasks import Balance, JointBounds, LeastForces, OperationalPoint, Posture, TorqueBounds

robot, period, seconds = Robot.load("hrp2"), 0.002, 1.0
motion = Motion.standing(robot, seconds)

stack = Stack(
    contacts=[Contact(robot.surface(foot)) for foot in robot.feet],
    hard=[TorqueBounds(robot), JointBounds(robot)],
    levels={  # most important first
        "balance": [Balance(motion.balance)],
        "waist": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="RPY")],
        "posture": [Posture(robot, motion.joints)],
        "forces": [LeastForces()],
    },
)

controller, world = Controller(robot, stack, Cascade(), period), World(robot, period)
for k in range(round(seconds / period)):
    command = controller(k * period, *world.state())
    world.step(command.torque)
print(stack.status(controller.tick, command.solution))
