"""How high hips may be over feet: as high as a leg reaches that is as straight as the dancer's."""

import numpy as np
import pytest

from sot.motion.body.coordinates import from_configuration
from sot.motion.body.height import LEG_EXTENSION_RANGE, reachable_hip_height
from sot.motion.body.targets import leg_extension
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.swing import standing_paths
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from tests.sot.motion.human.humans import dancer


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def highest(robot, shares):
    """The greatest heights of the hips at rest, for legs extended to shares (T,) of their length."""
    y = np.tile(from_configuration(robot.rest[None]), (len(shares), 1))
    feet = standing_paths(planted_phases(robot, 1.0)[0], len(shares))
    own = dict(zip(feet, (shares, shares), strict=True))
    return reachable_hip_height(robot, y, feet, own)


def test_hips_get_higher_with_the_dancers_legs_and_only_within_a_range(robot):
    least, most = LEG_EXTENSION_RANGE
    bent, low, high, straight = highest(robot, np.array([0.9, least, most, 1.0]))
    assert bent == low < high == straight
    assert high - low == pytest.approx((most - least) * leg_length(robot), rel=0.05)


def test_nobody_knows_a_dancers_legs_where_there_is_none(robot):
    y, feet = from_configuration(robot.rest[None]), standing_paths(planted_phases(robot, 1.0)[0], 1)
    assert reachable_hip_height(robot, y, feet) == highest(robot, np.array([LEG_EXTENSION_RANGE[0]]))


def test_a_leg_is_extended_by_how_far_the_ankle_is_from_the_hip():
    human = dancer(1.0)
    extension = leg_extension(human, "left")
    assert extension.shape == (human.count,) and np.all((extension > 0.5) & (extension <= 1.0 + 1e-9))
    hip, ankle = human.points["left_hip"], human.points["left_ankle"]
    human.points["left_knee"][:] = 0.5 * (hip + ankle)
    np.testing.assert_allclose(leg_extension(human, "left"), 1.0)
