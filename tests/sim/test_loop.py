"""What a run keeps of ticks that went otherwise than they should."""

import numpy as np
import pytest

from scenarios import stacks
from sim.loop import run
from sim.world import World
from solvers import Cascade, Status
from solvers.rows import Rows
from sot.control.controller import Controller
from sot.control.task import Task
from sot.robots.robot import Robot
from tests.sim.runs import PERIOD, still_motion


class Stumbling(Cascade):
    """Has no answer of its own for the third level of its fifth tick, nor for any of its seventh."""

    ticks = 0

    def solve(self, levels):
        solution = super().solve(levels)
        self.ticks += 1
        for tick, level, status in ((5, 3, Status.SECOND_SOLVER), (7, 0, Status.FAILED)):
            if self.ticks == tick:
                result = solution.levels[level]
                solution.status = result.status = status
                result.reason, result.residual = "stumbled", 1e-9
        return solution


class Impossible(Task):
    """Wants a joint to go both ways."""

    equality = False
    gives_way = 1

    def rows(self, tick) -> Rows:
        A = np.zeros((2, tick.robot.nv))
        A[:, 6] = 1.0, -1.0
        return self.make_rows(A, np.ones(2), np.full(2, np.inf))


@pytest.fixture
def motion():
    return still_motion(Robot.load("hrp2"), 10 * PERIOD)


def test_fallbacks_are_kept_with_their_time_level_and_reason(motion):
    controller = Controller(motion.robot, stacks.planted_stack(motion.robot, motion), Stumbling(), PERIOD)
    second, failed = run(controller, World(motion.robot, PERIOD), motion).log.fallbacks
    assert (second.t, second.level, second.residual) == (pytest.approx(4 * PERIOD), "posture", 1e-9)
    assert second.reason == "stumbled"
    assert (failed.t, failed.level) == (pytest.approx(6 * PERIOD), "hard")
    assert failed.reason == "stumbled; the last torque was held"


def test_conflicts_are_explained_after_the_run(motion):
    stack = stacks.planted_stack(motion.robot, motion)
    stack.hard.append(Impossible("Impossible", "rad/s²", "rad"))
    done = run(Controller(motion.robot, stack, Cascade(), PERIOD), World(motion.robot, PERIOD), motion)
    ((t, rows),) = done.log.conflicts
    assert t == 0.0 and rows.startswith("Impossible: row ") and rows.endswith("lower")
