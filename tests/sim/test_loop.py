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


class Spoilt(Task):
    """Now and then asks for what is no number, or returns rows of another width."""

    def rows(self, tick) -> Rows:
        k = round(tick.t / PERIOD)
        A = np.zeros((1, tick.robot.nv - (k == 7)))
        A[0, -1] = 1.0
        wanted = np.full(1, np.nan if k in (3, 4) else 0.0)
        return self.make_rows(A, wanted, wanted)


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


def test_values_that_cannot_be_used_are_counted_and_the_robot_stands(motion):
    stack = stacks.planted_stack(motion.robot, motion)
    stack.add(Spoilt("spoilt", "rad/s²", "rad"), "spoilt", before="posture")
    world = World(motion.robot, PERIOD)
    done = run(Controller(motion.robot, stack, Cascade(), PERIOD), world, motion)
    log = done.log.trimmed()
    assert done.fell_at_s is None and log.ticks == 10
    assert [round(t / PERIOD) for t, _ in log.invalid] == [3, 4, 7]
    assert all(what.startswith("task 'spoilt': ") for _, what in log.invalid)
    assert np.flatnonzero(log.status == Status.INVALID).tolist() == [3, 4, 7]
    assert np.isfinite(log.torque).all() and not log.fallbacks
    np.testing.assert_allclose(world.state()[0], motion.q[-1], atol=1e-3)


def test_a_run_starts_with_what_was_asked_for_at_its_end(motion):
    """A stack that has run takes changes at once again, before the next run."""
    robot, stack = motion.robot, stacks.planted_stack(motion.robot, motion)
    controller = Controller(robot, stack, Cascade(), PERIOD)
    run(controller, World(robot, PERIOD), motion)
    stack.remove("waist RPY")
    assert stack.transition_shares
    log = run(controller, World(robot, PERIOD), motion).log
    assert not any("waist RPY" in name for name in log.level_names)
