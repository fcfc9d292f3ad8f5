"""A foot that really slides on MuJoCo's floor, lightly loaded, while the other one carries."""

import numpy as np
import pytest

from scenarios import sliding
from sim import figures
from sim.log import FOOT_SLIDING
from sim.loop import run
from sim.world import World
from solvers import Cascade
from sot.controller import Controller
from sot.robot import Robot

RATE = 1000.0


@pytest.mark.slow
def test_slides_lightly_loaded_where_it_should():
    robot = Robot.load("hrp2")
    motion = sliding.motion(robot, RATE)
    stack, schedule = sliding.stack(robot, motion), sliding.schedule(robot, motion)
    done = run(Controller(robot, stack, Cascade(), 1.0 / RATE, schedule), World(robot, 1.0 / RATE), motion)
    assert done.fell_at_s is None, done.reason
    log, weight = done.log.trimmed(), 9.81 * robot.mass
    made = figures.contacts(log, robot)
    assert made["slide_m"] > 0.25
    assert made["slide_loaded"] > 0.6
    assert 0.04 * weight < made["slide_load_n"] < 0.15 * weight
    assert made["slip_max_m"] < 0.002
    assert figures.zmp(log, motion)["inside"] > 0.9
    slides = log.foot_mode[:, 1] == FOOT_SLIDING
    foot = figures.Points.of(robot, log.q[slides], (sliding.FOOT,))
    wanted = figures.Points.of(robot, motion.q[:-1][slides], (sliding.FOOT,))
    off = foot.positions[sliding.FOOT] - wanted.positions[sliding.FOOT]
    assert np.abs(off[:, :2]).max() < 0.01
    assert np.abs(foot.positions[sliding.FOOT][:, 2]).max() < 0.001
    assert figures.solver(log)["infeasible_ticks"] == 0
