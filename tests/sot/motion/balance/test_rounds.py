from dataclasses import replace

import numpy as np
import pytest

from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.rounds import WINDOW_OVERLAP_S, BalanceRounds, _windows
from sot.motion.body.coordinates import to_pinocchio
from sot.motion.body.limits import Limits
from sot.motion.body.spline import Spline
from sot.motion.body.targets import targets_of_human
from sot.motion.body.whole_body import retarget
from sot.motion.feet.course import stepping_course
from sot.motion.feet.stance import Build, human_on_time_line
from sot.motion.feet.support import supports
from sot.motion.feet.swing import feet_heading
from sot.motion.fitter import PLAN_RATE, body_at_clock, slowed_knots
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import walker

PERIOD = 1.0 / PLAN_RATE
DISTURBED = slice(150, 175)  # knots


class Walk:
    """A walk of made-up feet, and the body that was balanced over them."""

    def __init__(self):
        self.robot = Robot.load("hrp2")
        build, limits = Build.of(self.robot), Limits.of(self.robot)
        course = stepping_course(human_on_time_line(walker(), PLAN_RATE), self.robot, build, None)
        wanted = targets_of_human(course.human, self.robot, build, feet_heading(course.feet))
        self.given = self.robot, build, wanted, course.feet, course.phases, limits
        self.supports, self.feet = supports(self.robot, course.phases), course.feet
        rounds = BalanceRounds(*self.given, retarget(self.robot, build, wanted, course.feet, limits, PERIOD))
        self.hasty, self.whole = rounds.balance_all(rough=True), rounds.body_motion

    def outside(self, whole: Spline) -> float:
        """How far the ZMP leaves what supports it [m], negative if it never does."""
        state = Centroidal.along(self.robot, *to_pinocchio(whole.knots, whole.velocities, whole.accelerations))
        zmp, times = state.zmp(), PERIOD * np.arange(len(whole.knots))
        ends = [*(support.start for support in self.supports[1:]), np.inf]
        return max(
            -support.polygon.margin(zmp[(times >= support.start) & (times < end)]).min(initial=np.inf)
            for support, end in zip(self.supports, ends, strict=True)
        )


@pytest.fixture(scope="module")
def walk():
    return Walk()


def test_a_body_is_balanced_over_its_feet(walk):
    assert not len(walk.hasty)
    assert walk.outside(walk.whole) < 0.0


def test_what_has_changed_is_balanced_anew_and_the_rest_stays(walk):
    control = walk.whole.control.copy()
    turn = 6 + walk.robot.groups["chest"][1]
    control[DISTURBED, turn] += 0.2 * np.sin(np.linspace(0.0, np.pi, DISTURBED.stop - DISTURBED.start))
    disturbed = Spline(control, PERIOD)
    assert walk.outside(disturbed) > 0.02
    changed = np.zeros(len(disturbed.knots), bool)
    changed[DISTURBED] = True
    rounds = BalanceRounds(*walk.given, disturbed)
    assert not len(rounds.balance_about(changed))
    assert walk.outside(rounds.body_motion) < 0.0
    moved = np.flatnonzero(np.abs(rounds.body_motion.control - disturbed.control).max(axis=1) > 0.0)
    around = round(WINDOW_OVERLAP_S / PERIOD)
    assert moved.min() >= DISTURBED.start - around + 3  # of control points: where a part begins it stays, to the
    assert moved.max() < DISTURBED.stop + around - 1  # acceleration


def test_parts_that_meet_are_one():
    flags = np.zeros(100, bool)
    flags[[3, 30, 38, 70]] = True
    assert _windows(flags, 5) == [slice(0, 9), slice(25, 44), slice(65, 76)]
    assert _windows(np.zeros(100, bool), 5) == []


def test_a_clock_tells_what_it_slows_down():
    slow = np.ones(100)
    slow[40:50] = 2.0
    clock = PERIOD * np.concatenate([[0.0], np.cumsum(slow[1:])])
    flags = slowed_knots(clock, PERIOD)
    assert len(flags) == 110
    np.testing.assert_array_equal(np.flatnonzero(flags)[[0, -1]], [39, 59])


def test_a_body_played_slower_in_between_is_the_same_before_and_after(walk):
    slow = np.ones(len(walk.whole.knots))
    slow[200:220] = 2.0
    clock = PERIOD * np.concatenate([[0.0], np.cumsum(slow[1:])])
    later = body_at_clock(walk.whole, clock)
    np.testing.assert_allclose(later.knots[:199], walk.whole.knots[:199], atol=1e-12)
    np.testing.assert_allclose(later.knots[240:], walk.whole.knots[220:], atol=1e-12)


def test_feet_out_of_reach_are_told_and_rounds_over_them_end(walk):
    """A foot asked for 0.8 m beside its path: rounds get worse and are undone, and the body stays where it was."""
    robot, build, wanted, feet, phases, limits = walk.given
    away = feet["left_foot"].position.copy()
    away[150:190, 1] += 0.8
    far = feet | {"left_foot": replace(feet["left_foot"], position=away)}
    rounds = BalanceRounds(robot, build, wanted, far, phases, limits, walk.whole)
    strained = rounds.balance_all()
    assert len(strained) and strained.min() < 150 * PERIOD < 189 * PERIOD <= strained.max()
    assert np.abs(rounds.body_motion.knots[:, :6] - walk.whole.knots[:, :6]).max() < 1.0


def test_a_round_that_is_worse_is_undone(walk):
    rounds = BalanceRounds(*walk.given, walk.whole)
    rounds.balance_all()
    before = rounds.body_motion.control.copy()
    part = slice(100, 200)

    def spoil(part):
        rounds.body_motion.control[part] += 1.0
        rounds._strain[part] = 1.0
        return np.ones(part.stop - part.start, bool)

    rounds._round = spoil
    left, worse = rounds._improve(part, np.zeros(100, bool), 3)
    assert worse and not left.any()
    np.testing.assert_array_equal(rounds.body_motion.control, before)
    rounds._round = lambda part: np.linalg.cholesky(-np.eye(2))
    assert rounds._improve(part, np.zeros(100, bool), 3)[1]
