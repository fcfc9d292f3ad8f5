"""A bag on the back and a pull at a hand, both known to the controller, which comes to know of the bag on the way."""
# python docs/examples/13_loads.py

import numpy as np

from scenarios.stacks import planted_stack
from sim import World
from solvers import Cascade
from sot.control import Carried, Controller, KnownWrench
from sot.motion import Motion
from sot.robots import Robot

robot, period = Robot.load("hrp2"), 0.002
motion = Motion.standing(robot, 3.0, 1.0 / period)
bag = Carried("chest", 8.0, com=(-0.2, 0.0, 0.12))  # kg, m in the point's frame
pull = KnownWrench("right_hand", lambda t: np.array([0.0, 0.0, -20.0 * min(t, 1.0)]))  # N, world axes
stack, world = planted_stack(robot, motion), World(robot, period, loads=[bag])
stack.add_load(pull)
controller, hand = Controller(robot, stack, Cascade(), period), world.model.site("right_hand").bodyid[0]
sway = []
for k in range(round(motion.duration / period)):
    if k == 500:
        stack.add_load(bag, ramp=0.5)  # fully known 0.5 s later; `stack.remove_load(bag.name)` takes it out
    world.data.xfrc_applied[hand, :3] = pull.wrench(k * period)[:3]
    world.step(controller(k * period, *world.state()).torque)
    sway.append(np.linalg.norm((controller.tick.com - motion.com[0])[:2]))
