"""A task that comes, gets another target and goes while the robot stands; it comes and goes gradually."""
# python docs/examples/09_task_added_live.py

from scenarios.stacks import planted_stack
from sim import World
from solvers import Cascade
from sot.control import Controller
from sot.motion import Motion
from sot.robots import Robot
from tasks import OperationalPoint

robot, period = Robot.load("hrp2"), 0.002
motion = Motion.standing(robot, 3.0, 1.0 / period)
stack, world = planted_stack(robot, motion), World(robot, period)
controller = Controller(robot, stack, Cascade(), period)
hand = OperationalPoint(robot, "right_hand", [0.35, -0.3, 0.9], axes="xyz", kp=25.0, name="hand")
torques, places = [], []
for k in range(round(motion.duration / period)):
    if k == 250:
        stack.add(hand, "hand", before="posture")  # eased in, within 0.2 s
    if k == 750:
        hand.reference = [0.35, -0.3, 0.95]  # at once: keep it near, or lead it over
    if k == 1250:
        stack.remove("hand")  # eased out
    torques.append(controller(k * period, *world.state()).torque)
    places.append(controller.tick.frame("right_hand").position.copy())
    world.step(torques[-1])
