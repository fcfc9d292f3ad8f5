"""The paper's variables and the condensed ones, on the states of a whole dance."""

import numpy as np
import pytest

from scenarios import stacks
from scenarios.inputs.clips import find_clip
from sim.loop import run
from sim.world import World
from solvers import Cascade, Status
from sot.control.controller import Controller
from sot.control.dynamics import Dynamics
from sot.control.tick import Tick
from sot.motion import plan, read, recognise
from sot.robots.robot import Robot

EVERY = 25  # ticks


@pytest.mark.slow
def test_full_and_condensed_agree_on_every_state_of_a_dance():
    robot = Robot.load("hrp2")
    motion = plan(recognise(read(find_clip("groove"))), robot).motion
    stack = stacks.planted_stack(robot, motion)
    log = run(Controller(robot, stack, Cascade()), World(robot), motion).log.trimmed()
    tick, solvers = Tick(robot), {form: Cascade() for form in ("condensed", "full")}
    tick.contacts = stack.contacts
    compared = 0
    for k in range(0, log.ticks, EVERY):
        tick.update(log.time[k], log.q[k].copy(), log.v[k].copy())
        answers = []
        for form, solver in solvers.items():
            dynamics = Dynamics(robot, form)
            solution = solver.solve(dynamics.assemble(tick, stack.contacts, stack.hard, stack.levels))
            assert solution.status <= Status.SECOND_SOLVER
            decoded = dynamics.decode(solution.x)
            answers.append((decoded.acceleration, decoded.torque, decoded.forces))
        for condensed, full in zip(*answers, strict=True):
            assert np.linalg.norm(condensed - full) <= 1e-6 * max(1.0, np.linalg.norm(full))
        compared += 1
    assert compared > 500
