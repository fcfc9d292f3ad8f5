"""The support of a run: the soles that the plan puts down, as long as their contacts carry."""

import numpy as np
import pytest

from sim.log import FOOT_OFF
from sim.support import support_extents
from sot.robots.robot import Robot
from tests.sim.runs import perfect_log, still_motion


def test_sides_are_those_of_the_soles_that_carry():
    motion = still_motion(Robot.load("hrp2"), 2.0)
    log = perfect_log(motion).trimmed()
    log.foot_mode[100:300, 1] = FOOT_OFF
    log.foot_mode[200:300, 0] = FOOT_OFF
    log.foot_ramp[300:, 1] = 0.5
    left, right = (
        np.array([motion.phases[0].feet[foot].act(corner)[:2] for corner in motion.robot.sole(foot)])
        for foot in motion.robot.feet
    )
    both = np.concatenate([left, right])
    sides = support_extents(log, motion)
    for rows, soles in ((slice(0, 100), both), (slice(100, 200), left), (slice(300, None), left)):
        expected = np.array([soles.min(axis=0), soles.max(axis=0)])
        assert sides[rows] == pytest.approx(np.broadcast_to(expected, sides[rows].shape))
    assert np.isnan(sides[200:300]).all()
