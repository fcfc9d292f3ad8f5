"""Feet that step by what a person asks: in reach, one after the other, with a balance that leads through every step."""

from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest

from sot.gravity import GRAVITY
from sot.live.reference import PERIOD
from sot.live.steps.footing import MAX_BACKLOG_TIME, MIN_DOUBLE_SUPPORT_TIME, SteppingFooting
from sot.live.steps.person_steps import AskedStep
from sot.live.steps.preview import KNOT_PERIOD
from sot.live.steps.reachable import MAX_SWING_ACCELERATION_G, live_reach, reachable_foothold
from sot.live.steps.step_plan import rooms_at
from sot.motion.feet.contacts import support_polygon
from sot.motion.feet.footholds import min_ankle_separation
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.support import supports
from sot.robots.robot import Robot
from sot.robots.stance_range import Stance


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def asked(foot, lift, dx, dy=0.0, turn=0.0, **other):
    """A step that brings a foot so far beside the other one, which stands at the origin."""
    aside = 0.17 if foot == "left_foot" else -0.17
    still = Foothold(0.0, 0.0, 0.0)
    return AskedStep(foot, lift, lift + 0.5, still, Foothold(dx, aside + dy, turn), still, has_landed=True, **other)


def play(footing, until, start=0.0, wanted=None):
    """Centre of mass, zero-moment point and poses of the feet at the knots up to a time."""
    height, out = 0.8, []
    for k in range(round(start / PERIOD), round(until / PERIOD)):
        t = k * PERIOD
        middle = np.mean([(at.x, at.y) for at in footing.stands.values()], axis=0)
        com = footing.advance(t, PERIOD, middle if wanted is None else wanted, (), height)
        out.append((t, com, footing.poses(t), footing.excess))
    return out


def test_steps_are_made_one_after_the_other_and_the_plan_stays_inside_the_soles(robot):
    footing, begun = SteppingFooting(robot), []
    footing.begun.append(lambda *step: begun.append(step))
    footing.asked += [asked("left_foot", 1.0, 0.2), asked("right_foot", 1.5, 0.2), asked("left_foot", 2.0, 0.0)]
    knots = play(footing, 5.0)
    assert [foot for foot, _, _ in begun] == ["left_foot", "right_foot", "left_foot"]
    for (_, _, land), (_, lift, _) in pairwise(begun):
        assert lift - land > 0.1
    assert max(excess for *_, excess in knots) < 2e-3
    c, dc, _ = knots[-1][1]
    feet = support_polygon(robot, footing.phases(5.0)[-1])
    assert feet.margin(c) > 0.03 and np.linalg.norm(dc) < 0.02
    assert len(footing.phases(5.0)) == 7


def test_the_zero_moment_point_of_the_pendulum_is_in_the_support_of_its_time(robot):
    footing = SteppingFooting(robot)
    footing.asked += [asked("left_foot", 1.0, 0.2), asked("right_foot", 1.5, 0.2)]
    knots = play(footing, 4.0)
    preview, stands = footing._preview, supports(robot, footing.phases(4.0))
    for t, (c, _, ddc), _, _ in knots[::4]:
        support = next(one for one in reversed(stands) if one.start <= t + 1e-9)
        # What the swinging leg takes is in the plan; a third of a sole's breadth is more than that is sideways.
        assert support.polygon.margin(c - ddc * preview._over) > -0.06


def test_feet_go_from_foothold_to_foothold_without_a_jump(robot):
    footing = SteppingFooting(robot)
    footing.asked += [asked("left_foot", 1.0, 0.2, turn=0.3)]
    knots = play(footing, 3.0)
    places = np.array([poses["left_foot"].position for _, _, poses, _ in knots])
    assert np.abs(np.diff(places, axis=0)).max() < 0.02
    assert places[:, 2].max() > 0.03 and places[-1, 2] == pytest.approx(places[0, 2])
    at = footing.stands["left_foot"]
    assert at.x == pytest.approx(0.2, abs=0.01) and at.heading == pytest.approx(0.3, abs=1e-6)


def test_a_foothold_that_changes_while_the_foot_is_in_the_air_is_followed(robot):
    footing = SteppingFooting(robot)
    step = asked("left_foot", 1.0, 0.2)
    step.has_landed = False
    footing.asked.append(step)
    play(footing, 1.1)
    step.place = Foothold(0.05, 0.2, 0.0)
    play(footing, 3.0, start=1.1)
    assert footing.stands["left_foot"].x == pytest.approx(0.05, abs=0.01)


def test_a_decided_step_goes_elsewhere_only_as_far_as_balance_leads_through_it(robot, monkeypatch):
    footing, step = SteppingFooting(robot), asked("left_foot", 1.0, 0.0)
    step.has_landed = False
    footing.asked.append(step)
    play(footing, 0.7)
    (decided,) = footing._steps
    solved = footing._solved

    def solved_near(t, steps, wanted, future):
        return solved(t, steps, wanted, future)[0], 0.01 if any(one.place.x > 0.1 for one in steps) else 0.0

    monkeypatch.setattr(footing, "_solved", solved_near)
    step.place = Foothold(0.3, step.place.y, 0.0)
    play(footing, 0.75, start=0.7)
    assert footing._steps == [decided] and 0.05 < decided.place.x < 0.1


def test_a_foot_is_led_elsewhere_no_faster_than_feet_may_go(robot):
    footing = SteppingFooting(robot)
    step = asked("left_foot", 1.0, 0.2)
    step.has_landed = False
    footing.asked.append(step)
    play(footing, 1.1)
    lift = next(one.lift for one in footing._steps)
    knots = play(footing, lift + 0.2, start=1.1)
    step.place = Foothold(-0.3, 0.5, 0.0)
    knots = play(footing, 3.0, start=lift + 0.2)
    fastest = max(np.linalg.norm(poses["left_foot"].acceleration[:2]) for _, _, poses, _ in knots)
    assert fastest < 1.05 * MAX_SWING_ACCELERATION_G * GRAVITY
    assert footing.stands["left_foot"].x > -0.1, "it had no time for all of it"
    assert max(excess for *_, excess in knots) < 0.02


def test_a_foot_that_had_no_time_to_get_where_the_person_landed_steps_again(robot):
    footing = SteppingFooting(robot)
    step = asked("left_foot", 1.0, 0.2)
    step.has_landed = False
    footing.asked.append(step)
    play(footing, 1.1)
    late = footing._steps[0].land - 0.2
    play(footing, late, start=1.1)
    step.place, step.has_landed = Foothold(-0.15, 0.2, 0.0), True
    play(footing, 4.0, start=late)
    assert [one.foot for one in footing.made] == ["left_foot", "left_foot"]
    assert footing.made[0].place.x > 0.0, "it had no time for all of it"
    assert footing.stands["left_foot"].x == pytest.approx(-0.15, abs=0.02)


def test_the_body_stays_where_the_legs_of_feet_far_apart_reach(robot):
    footing, behind = SteppingFooting(robot), []
    footing.asked.append(asked("left_foot", 1.0, 0.0, dy=0.5))
    for t, (c, _, _), _, _ in play(footing, 4.0, wanted=np.array([0.0, 0.6])):
        if footing.made and t > footing.made[-1].land + 0.1:
            behind.append(-footing._rooms(footing.stands).reach.margin(c))
    assert len(footing.made) == 1 and footing.stands["left_foot"].y > 0.25
    assert max(behind) < 5e-3


def test_who_is_far_behind_leaves_out_what_later_steps_have_made_needless(robot):
    footing = SteppingFooting(robot)
    late = MAX_BACKLOG_TIME * footing._time
    for k in range(3):
        footing.asked += [asked("left_foot", 0.1, 0.05 * k), asked("right_foot", 0.1, 0.05 * k)]
    play(footing, late + 2.0, start=round(late + 0.2, 2))
    assert [step.foot for step in footing.made] == ["right_foot", "left_foot", "right_foot"]
    assert footing.made[-1].asked.place.x == pytest.approx(0.1)


def test_what_follows_waits_for_a_foot_that_is_late(robot):
    footing = SteppingFooting(robot)
    footing.asked += [asked("left_foot", 1.0, 0.2), asked("right_foot", 1.5, 0.2)]
    play(footing, 1.3)
    first, late = footing._steps[0], 3 * KNOT_PERIOD
    footing.aloft = {"left_foot"}
    knots = play(footing, first.land + late - 0.5 * KNOT_PERIOD, start=1.3)
    assert footing.made == [] and max(excess for *_, excess in knots) < 0.02
    (alone,), _ = rooms_at(np.array([first.land + late]), footing.stands, footing._steps, footing._rooms)
    assert alone.is_single, "the foot that is late is not counted on"
    footing.aloft = set()
    knots = play(footing, 4.0, start=first.land + late)
    one, other = footing.made
    assert one.stands == pytest.approx(first.land + late, abs=1e-6)
    assert other.lift - one.stands > MIN_DOUBLE_SUPPORT_TIME * footing._time
    assert max(excess for *_, excess in knots) < 0.02


def test_no_foot_lifts_while_the_robot_is_off_its_plan(robot):
    footing = SteppingFooting(robot)
    footing.asked += [asked("left_foot", 1.0, 0.2)]
    play(footing, 0.8)
    assert len(footing._steps) == 1
    footing.is_disturbed = True
    play(footing, 2.0, start=0.8)
    assert not footing.made and footing._stride is None
    footing.is_disturbed = False
    play(footing, 3.5, start=2.0)
    assert [step.foot for step in footing.made] == ["left_foot"] and footing.made[0].lift > 2.0


@pytest.mark.parametrize("extension", [0.94, 0.75, 0.55])
def test_knees_are_apart_over_footholds_that_point_at_each_other(robot, extension):
    reach, stance, random = live_reach(robot), Stance(robot), np.random.default_rng(1)
    beside, turns = Foothold(0.0, 0.0, 0.0), []
    for _ in range(20):
        wanted = Foothold(0.0, random.uniform(0.0, 0.2), -random.uniform(0.0, 1.0))
        found = reachable_foothold(reach, "left_foot", wanted, Foothold(0.0, 0.17, 0.0), beside, 0.5)
        out, turns = 0.5 * (found.y - beside.y - reach.hip_width), [*turns, found.heading]
        down = np.sqrt((extension * reach.leg_length) ** 2 - out**2)
        ankles = [np.array([0.0, out, -down]), np.array([0.0, -out, -down])]
        posture = [leg.rest for leg in stance.legs]
        for share in np.linspace(0.0, 1.0, 10):
            yaws = np.array([0.5, -0.5]) * share * found.heading
            posture = stance.postures(posture, ankles, [pin.utils.rotate("z", yaw) for yaw in yaws])
        assert stance.are_apart(posture)
    assert min(turns) < -0.05


@pytest.mark.parametrize("foot", ["left_foot", "right_foot"])
def test_footholds_are_in_reach_uncrossed_and_clear(robot, foot):
    reach, random = live_reach(robot), np.random.default_rng(3)
    sign = 1.0 if foot == "left_foot" else -1.0
    for _ in range(50):
        beside = Foothold(*random.uniform(-1.0, 1.0, 3))
        across = np.array([-np.sin(beside.heading), np.cos(beside.heading)])
        x, y = np.array([beside.x, beside.y]) + 0.2 * sign * across
        start = Foothold(x, y, beside.heading)
        wanted = Foothold(x + random.normal(0, 1), y + random.normal(0, 1), beside.heading + random.normal(0, 1))
        found = reachable_foothold(reach, foot, wanted, start, beside, 0.5)
        way = np.array([found.x - beside.x, found.y - beside.y])
        middle = 0.5 * (found.heading + beside.heading)
        aside = np.array([-np.sin(middle), np.cos(middle)])
        yaws = (found.heading, beside.heading) if sign > 0.0 else (beside.heading, found.heading)
        assert sign * way @ aside > min_ankle_separation(yaws, reach, aside) - 1e-6
        assert np.linalg.norm(way) < reach.max_stride + reach.hip_width
        assert reach.toe_out_range[0] - 1e-9 <= yaws[0] - yaws[1] <= reach.toe_out_range[1] + 1e-9


def test_what_is_in_reach_is_kept(robot):
    reach, beside = live_reach(robot), Foothold(0.0, 0.0, 0.0)
    wanted = Foothold(0.1, 0.2, 0.2)
    found = reachable_foothold(reach, "left_foot", wanted, Foothold(0.0, 0.17, 0.0), beside, 0.5)
    assert (found.x, found.y, found.heading) == pytest.approx((wanted.x, wanted.y, wanted.heading))


def test_nobody_asks_and_the_feet_stay(robot):
    footing = SteppingFooting(robot)
    knots = play(footing, 1.0)
    com = pin.centerOfMass(robot.model, robot.model.createData(), robot.rest)[:2]
    assert np.linalg.norm(knots[-1][1][0] - com) < 0.05
    assert len(footing.phases(1.0)) == 1
