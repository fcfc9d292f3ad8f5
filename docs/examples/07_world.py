"""The loop with the project's `World`: sensors, a push, a robot that is heavier than its model says, a log."""
# python docs/examples/07_world.py

import numpy as np

from scenarios.stacks import planted_stack
from sim import Mismatch, Push, World, run
from solvers import Cascade
from sot.control import Controller
from sot.motion import Motion
from sot.robots import Robot

robot, period = Robot.load("hrp2"), 0.002
motion = Motion.standing(robot, 2.0, 1.0 / period)
world = World(
    robot,
    period,
    mismatch=Mismatch(mass=1.05, delay=0.002),
    pushes=[Push(t=0.5, force=(50.0, 0.0, 0.0), duration=0.1)],
)
controller = Controller(robot, planted_stack(robot, motion), Cascade(), period)
done = run(controller, world, motion)
log = done.log.trimmed()
sway = np.linalg.norm((log.com - motion.com[0])[:, :2], axis=1)
print(f"fell: {done.fell_at_s}, swayed by {1e3 * sway.max():.0f} mm, {1e3 * sway[-1]:.0f} mm at the end")
print("load on the left foot at the end:", world.foot_wrenches()["left_foot"][2].round(), "N")
