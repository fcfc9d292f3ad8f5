"""What a stack makes of a motion: all of it, whatever the floor would have to give; and a balance that suits it."""

from dataclasses import replace

import numpy as np
import pytest

from solvers import Cascade
from sot.behaviours.rehearsal import KNOT_RATE, rebalance, rehearse
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.feet.contacts import support_polygon
from sot.motion.feet.support import supports
from sot.robots.robot import Robot
from tasks import Balance, LeastForces, Posture
from tests.sim.runs import still_motion

SECONDS = 2.0


@pytest.fixture(scope="module")
def still():
    return still_motion(Robot.load("hrp2"), SECONDS)


def stack(motion, **posture):
    """Balance and a posture, without limits."""
    robot = motion.robot
    return Stack(
        contacts=[Contact(robot.surface(foot)) for foot in robot.feet],
        hard=[],
        levels={
            "balance": [Balance(motion.balance, motion.feet, axes="xy")],
            "posture": [Posture(robot, motion.joints, **posture)],
            "forces": [LeastForces()],
        },
    )


def swinging(still, frequency, angle):
    """Both arms swing to and fro together, sin³ at each end of the motion."""
    robot, times = still.robot, still.times
    share = np.sin(np.pi * times / SECONDS) ** 3
    swing = angle * share * np.sin(2.0 * np.pi * frequency * times)
    q, v, a = still.q.copy(), still.v.copy(), still.a.copy()
    for joint in ("RARM0", "LARM0"):
        k = robot.joints.index(joint)
        q[:, 7 + k] += swing
        v[:, 6 + k] = np.gradient(swing, times)
        a[:, 6 + k] = np.gradient(v[:, 6 + k], times)
    return replace(still, q=q, v=v, a=a)


def test_at_rest_nothing_happens(still):
    made = rehearse(still, stack(still), Cascade())
    assert len(made.com) == round(SECONDS * KNOT_RATE) + 1
    np.testing.assert_allclose(made.com, still.com[: len(made.com)], atol=1e-6)
    np.testing.assert_allclose(made.rate, 0.0, atol=1e-4)


def test_a_posture_that_lags_swings_as_the_filter_that_it_is(still):
    """Ramos (17) as a filter, (2 ω s + ω²) / (s + ω)²: of a swing at 2 ω, √17 / 5 is left; and the momentum with it."""
    frequency = 2.0 * 5.0 / (2.0 * np.pi)
    motion = swinging(still, frequency, 0.2)
    exact, lagging = (
        rehearse(motion, stack(motion, **gains), Cascade()) for gains in ({}, {"kp": 25.0, "feedforward": False})
    )
    middle = slice(round(0.4 * SECONDS * KNOT_RATE), round(0.8 * SECONDS * KNOT_RATE))
    left = lagging.momentum[middle, 4].std() / exact.momentum[middle, 4].std()
    assert left == pytest.approx(np.sqrt(17.0) / 5.0, abs=0.08)


def test_what_no_floor_gives_is_done_all_the_same(still):
    """Arms so fast that the floor would have to push from outside the soles: done, and told."""
    motion = swinging(still, 2.5, 0.9)
    made = rehearse(motion, stack(motion, kp=400.0), Cascade())
    soles = support_polygon(motion.robot, motion.phases[0])
    assert soles.margin(made.zmp()).min() < -0.02


def test_the_balance_then_suits_what_the_stack_makes_of_it(still):
    """z = c − h c̈ + offset of the new centre of mass with the rehearsed momentum: as told, and where it should be."""
    motion = swinging(still, 2.0, 0.5)
    made = rehearse(motion, stack(motion), Cascade())
    (where,) = supports(motion.robot, motion.phases)
    assert where.inset.margin(made.zmp()).min() < -0.005  # with the centre of mass where it was
    new = rebalance(motion, made)
    np.testing.assert_array_equal(new.q, motion.q)
    rows = np.round(np.arange(len(made.com)) / KNOT_RATE * motion.rate).astype(int)
    rows = rows[10:-10]
    offset = made.pendulum()[1][10:-10]
    lever = new.com[rows, 2] / (GRAVITY + new.com_acceleration[rows, 2])
    zmp = new.com[rows, :2] - lever[:, None] * new.com_acceleration[rows, :2] + offset
    np.testing.assert_allclose(new.zmp[rows], zmp, atol=1e-4)
    assert where.inset.margin(new.zmp[rows]).min() > -1e-4
    np.testing.assert_allclose(np.gradient(new.com, new.times, axis=0)[rows, :2], new.com_velocity[rows, :2], atol=2e-3)


def test_a_stack_that_runs_away_is_told(still):
    with pytest.raises(InputError, match="beyond all bounds"):
        rehearse(swinging(still, 2.0, 0.1), stack(still, kp=1e6), Cascade())
