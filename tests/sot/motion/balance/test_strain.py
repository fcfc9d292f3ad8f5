from dataclasses import replace

import numpy as np
import pytest

from sot.motion.balance.strain import MAX_FOOT_ERROR_LEGS, Shortfall, feet_strain, shortfall_remark, shortfalls
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.support import supports
from sot.motion.feet.swing import standing_paths
from sot.robots.robot import Robot
from sot.robots.size import leg_length


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def test_a_robot_that_stands_falls_short_of_nothing_and_one_whose_foot_is_off_does(robot):
    body = Spline.through(np.tile(from_configuration(robot.rest[None]), (100, 1)), 0.02)
    phases = planted_phases(robot, 2.0)
    feet, where = standing_paths(phases[0], 100), supports(robot, phases)
    assert shortfalls(robot, feet, where, body) == []
    away = feet["left_foot"].position.copy()
    away[40:50, 0] += 0.03
    away[55:60, 0] += 0.01
    (found,) = shortfalls(robot, feet | {"left_foot": replace(feet["left_foot"], position=away)}, where, body)
    assert (found.start, found.end) == (pytest.approx(0.8), pytest.approx(1.18))
    assert found.foot == pytest.approx(0.03) and found.zmp == 0.0


def test_a_foot_strains_where_it_is_far_off_its_path(robot):
    body = Spline.through(np.tile(from_configuration(robot.rest[None]), (10, 1)), 0.02)
    feet = standing_paths(planted_phases(robot, 0.2)[0], 10)
    away = feet["left_foot"].position.copy()
    away[4, 0] += 0.03
    strain = feet_strain(robot, feet | {"left_foot": replace(feet["left_foot"], position=away)}, body, slice(2, 8))
    assert strain[2] == pytest.approx(0.03 - MAX_FOOT_ERROR_LEGS * leg_length(robot))
    assert np.all(np.delete(strain, 2) < 0.0)


def test_a_remark_gives_the_times_in_the_clip():
    found = [Shortfall(2.0, 3.0, 0.012, 0.0), Shortfall(5.0, 5.5, 0.0, 0.03)]
    said = shortfall_remark(found, lambda t: t - 1.0)
    assert "1.0 to 2.0 s, 4.0 to 4.5 s" in said and "12 mm" in said and "30 mm" in said
