"""A limit of one's own: a ceiling over the right hand, which a task would take through it."""
# python docs/examples/03_own_limit.py

import numpy as np

from scenarios.stacks import planted_stack
from sim import World, run
from solvers import Cascade
from sot.control import Controller, Task
from sot.motion import Motion
from sot.robots import Robot
from tasks import AccelerationBounds, OperationalPoint

HAND, HEIGHT, NONE = "right_hand", 0.9, np.full(1, np.inf)


class Ceiling(Task):
    # Rows lower <= A v̇ <= upper: an acceleration after which the height can still be kept.
    equality = False  # a limit
    gives_way = 1  # first, where limits contradict one another
    bounds = AccelerationBounds(-NONE, np.array([HEIGHT]), NONE, np.array([10.0]), NONE)  # braking with 10 m/s²

    def rows(self, tick):
        hand = tick.frame(HAND)
        lower, upper = self.bounds(hand.position[2:3], hand.velocity[2:3], tick.period)
        return self.make_rows(hand.jacobian[2:3], lower - hand.drift[2:3], upper - hand.drift[2:3])


robot = Robot.load("hrp2")
motion = Motion.standing(robot, 2.0, 500.0)
stack = planted_stack(robot, motion)
stack.hard.append(Ceiling("ceiling", unit="m/s²", error_unit="m"))
stack.add(OperationalPoint(robot, HAND, [0.3, -0.3, 1.1], axes="xyz", kp=25.0), "hand", before="posture")
done = run(Controller(robot, stack, Cascade(), 0.002), World(robot, 0.002), motion)
