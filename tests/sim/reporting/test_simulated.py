"""A run as the project's own file of motions."""

from dataclasses import replace

import numpy as np

from sim.log import RunInfo, RunLog
from sim.mismatch import Mismatch
from sim.reporting.simulated import simulated_motion
from sot.gravity import GRAVITY
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

PERIOD = 0.005


def test_margins_contacts_and_facts():
    robot = Robot.load("hrp2")
    motion = Motion.standing(robot, 0.5, 1.0 / PERIOD)
    log = RunLog.allocate(robot, 20)
    log.ticks = 10
    log.time[:10] = PERIOD * np.arange(10)
    log.q[:10], log.v[:10], log.torque[:10] = robot.rest, 0.0, 1.0
    log.v[:10, 6] = log.time[:10] * 3.0
    weight = robot.mass * GRAVITY
    log.foot_wrench[:10] = 0.0
    log.foot_wrench[:10, 0, :3] = [0.1 * weight, 0.0, weight]
    log.foot_mode[:10], log.foot_ramp[:10] = 1, 1.0
    log.zmp_measured[:10] = motion.zmp[0]
    info = RunInfo("clip", "hrp2", "cascade", "planted", 200.0, mismatch=Mismatch(friction=0.5), licence="CC0 1.0")
    found = simulated_motion(log, info, motion)
    assert found.q.shape == (10, robot.nq) and abs(found.rate - 200.0) < 1e-9
    assert found.contact.tolist() == [[True, False]] * 10
    assert np.allclose(found.friction_margin[:, 0], 0.4 * weight) and np.isnan(found.friction_margin[:, 1]).all()
    assert (found.zmp_margin > 0.0).all() and np.allclose(found.a[:, 6], 3.0)
    assert found.facts["ended"] == "upright" and found.facts["licence"] == "CC0 1.0"
    fallen = simulated_motion(log, replace(info, fell_at_s=0.04, reason="it fell"), motion)
    assert fallen.facts["ended"] == "fell at 0.04 s: it fell"
