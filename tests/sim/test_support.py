"""The support of a run: the soles that the plan puts down, as long as their contacts carry."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sim.log import FOOT_OFF
from sim.support import ground_heights, support_extents
from sot.motion.feet.contacts import Phase
from sot.motion.trajectory import Motion
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


def test_heights_are_the_mean_of_the_standing_feet_and_stay_in_flights():
    motion = Motion.standing(Robot.load("hrp2"), 1.0, 100.0)
    low, high = (pin.SE3(np.eye(3), np.array([0.0, 0.0, z])) for z in (0.1, 0.3))
    feet = {"left_foot": low, "right_foot": high}
    phases = (Phase(0.0, 0.4, feet), Phase(0.4, 0.6, {"right_foot": high}), Phase(0.6, 0.8, {}), Phase(0.8, 1.0, feet))
    times = np.array([0.2, 0.5, 0.7, 0.9])
    np.testing.assert_allclose(ground_heights(replace(motion, phases=phases), times), [0.2, 0.3, 0.3, 0.2])
    np.testing.assert_allclose(ground_heights(motion, times), 0.0, atol=1e-12)
