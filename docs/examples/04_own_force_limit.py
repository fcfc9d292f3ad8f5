"""A limit on contact forces: the toes of the left foot carry next to nothing."""
# python docs/examples/04_own_force_limit.py

import numpy as np

from scenarios.stacks import planted_stack
from sim import World, run
from solvers import Cascade
from sot.control import Controller, Task
from sot.motion import Motion
from sot.robots import Robot

FOOT, MOST = "left_foot", 20.0  # N


class SpareToes(Task):
    # Rows lower <= A φ <= upper on the force variables φ of all contacts: x, y, z at vertex after vertex.
    variable = "force"
    equality = False
    gives_way = 3

    def rows(self, tick):
        A, forces = np.zeros((1, tick.force_count)), tick.force_columns(FOOT)
        ahead = tick.contact(FOOT).vertices[:, 0] > 0.0
        A[0, forces] = np.kron(ahead, [0.0, 0.0, 1.0])  # the normal force of each vertex ahead of the ankle
        return self.make_rows(A, np.array([-np.inf]), np.array([MOST]))


robot = Robot.load("hrp2")
motion = Motion.standing(robot, 1.0, 500.0)
stack = planted_stack(robot, motion)
stack.hard.append(SpareToes("spare toes", unit="N", error_unit="N"))
world = World(robot, 0.002)
done = run(Controller(robot, stack, Cascade(), 0.002), world, motion)
