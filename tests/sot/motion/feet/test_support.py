"""Where a plan may have the zero-moment point."""

import numpy as np
import pytest

from sot.motion.balance.feet_led import feet_led
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.support import supports
from sot.motion.way import footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length

INSET = (0.11, 0.07)
"""Along and across the feet [leg lengths]."""


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def test_a_plan_may_keep_farther_from_the_edges(robot: Robot) -> None:
    leg = leg_length(robot)
    (support,) = supports(robot, planted_phases(robot, 1.0), INSET)
    for axis, inset in enumerate(INSET):
        outer, inner = support.polygon.vertices[:, axis], support.inset.vertices[:, axis]
        assert inner.max() == pytest.approx(outer.max() - inset * leg, abs=1e-6)
        assert inner.min() == pytest.approx(outer.min() + inset * leg, abs=1e-6)


def test_a_walk_keeps_its_pressure_near_the_middle_of_the_foot_that_stands_alone(robot: Robot) -> None:
    steps = footsteps_along(robot, [Foothold(0.1, 0.0, 0.0)])
    knots = 0.02 * np.arange(np.ceil(steps.end / 0.02) + 1)
    phases, paths = steps.feet_at(robot, knots)
    beyond = []
    for inset in ((0.0, 0.0), INSET):
        motion = feet_led(robot, phases, paths, 0.02, 100.0, inset=inset)
        zmp = motion.zmp
        allowed = [s for s in supports(robot, phases, INSET) if len(s.polygon.vertices) == 4]
        off = [s.inset.offsets - zmp[round((s.start + 0.2) * 100.0)] @ s.inset.normals.T for s in allowed]
        beyond.append(-min(float(distance.min()) for distance in off))
    assert beyond[0] > 0.01  # it would be nearer to the edge
    assert beyond[1] < 0.002
