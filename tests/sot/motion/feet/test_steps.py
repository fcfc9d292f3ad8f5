from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion import plan, read, recognise
from sot.motion.body.targets import targets_of_human
from sot.motion.feet.contacts import phase_indices
from sot.motion.feet.footholds import (
    MAX_FOOTHOLD_OFFSET,
    LegReach,
    min_ankle_separation,
    reachable_footholds,
    reachable_headings,
    standing_pairs,
)
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.path import ScalablePath
from sot.motion.feet.stance import Build, human_on_time_line, human_over_feet
from sot.motion.feet.support import FORCE_RAMP_TIME, supports
from sot.motion.feet.swing import HEIGHT_PROFILE_CURVATURE, _height_profile
from sot.motion.feet.tempo import (
    MIN_DOUBLE_SUPPORT_TIME,
    MIN_STANCE_TIME,
    MIN_SWING_TIME,
    AskedStep,
    clock_from_slowness,
    retimed_steps,
    step_tempo,
)
from sot.motion.feet.travel import KEPT_TIME_SHARE, travel_at_clock, with_time_kept
from sot.robots.leg_range import DIRECTION_COUNT, HIP_HEIGHTS_LEGS, RANGE_MARGIN, flat_foot_distances
from sot.robots.robot import Robot
from sot.robots.soles import front
from tests.sot.motion.human.humans import dancer, walker
from tests.sot.robots.thick_legs import with_thick_legs

MOCAP = Path(__file__).parents[5] / "shared" / "mocap"


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def walk(robot):
    return plan(walker(), robot, "steps", rate=500.0)


def assert_can_be_stepped(motion):
    """Feet still where they stand, flat unless a heel rises, clear of the floor between; the ZMP where feet carry."""
    robot = motion.robot
    index = phase_indices(motion.phases, motion.times)
    for foot in robot.feet:
        track = motion.track(foot)
        for number, phase in enumerate(motion.phases):
            rows = index == number
            if foot in phase.rising:
                toes = robot.sole(foot)[front(robot.sole(foot))]
                places = track.position[rows, None] + np.einsum("tij,cj->tci", track.rotation[rows], toes)
                planned = np.array([phase.feet[foot].act(toe) for toe in toes])
                assert np.linalg.norm(places - planned, axis=2).max() < 3e-3
            elif foot in phase.feet:
                assert np.linalg.norm(track.position[rows] - phase.feet[foot].translation, axis=1).max() < 3e-3
                assert np.abs(track.rotation[rows] - phase.feet[foot].rotation).max() < 5e-3
            else:
                assert track.position[rows, 2].max() > 0.03
                assert track.position[rows, 2].min() > -1e-3
    for start, support in [(support.start, support) for support in supports(robot, motion.phases)]:
        rows = (motion.times >= start) & (motion.times < start + 0.01)
        assert support.polygon.margin(motion.zmp[rows]).min() > 0.0
    assert np.all(motion.q[:, 7:] >= robot.lower) and np.all(motion.q[:, 7:] <= robot.upper)
    assert np.all(np.abs(motion.v[:, 6:]) <= robot.velocity)
    assert np.all(np.abs(motion.a[:, 6:]) <= robot.acceleration)


def test_a_walk_can_be_stepped(walk):
    assert_can_be_stepped(walk.motion)


def test_a_walk_is_followed_step_by_step(walk):
    motion = walk.motion
    swings = [phase for phase in motion.phases if len(phase.feet) == 1]
    standing = [next(iter(phase.feet)) for phase in swings]
    assert len(swings) == 6
    assert all(a != b for a, b in pairwise(standing))
    assert motion.com[-1, 0] - motion.com[0, 0] > 0.5


def test_ends_at_rest(walk):
    motion = walk.motion
    for end in (0, -1):
        np.testing.assert_allclose(motion.v[end], 0.0, atol=1e-6)
        np.testing.assert_allclose(motion.a[end], 0.0, atol=1e-4)


def test_soles_stay_apart_in_the_air(walk):
    robot, motion = walk.motion.robot, walk.motion
    left, right = (motion.track(foot) for foot in robot.feet)
    for k in range(0, len(motion.q), 5):
        poses = [pin.SE3(track.rotation[k], track.position[k]) for track in (left, right)]
        soles = [np.array([pose.act(c)[:2] for c in robot.sole(f)]) for f, pose in zip(robot.feet, poses, strict=True)]
        across = poses[0].rotation[:2, 1] + poses[1].rotation[:2, 1]
        across /= np.linalg.norm(across)
        assert (soles[0] @ across).min() - (soles[1] @ across).max() > 0.014


def test_one_foot_at_a_time():
    """A flight, two quick steps of a foot and a hasty one keep their order and get the time that they need."""
    moves = (
        Step("left_foot", 2.0, 2.5),
        Step("right_foot", 2.1, 2.5),
        Step("left_foot", 3.0, 3.4),
        Step("left_foot", 3.45, 3.9),
        Step("right_foot", 5.0, 5.1),
    )
    timed = retimed_steps(moves, [0.0] * len(moves))
    assert [step.foot for step in timed] == [step.foot for step in moves]
    for step in timed:
        assert step.land - step.lift > MIN_SWING_TIME - 1e-9
    for before, after in pairwise(timed):
        assert (
            after.lift - before.land
            > (MIN_STANCE_TIME if before.foot == after.foot else MIN_DOUBLE_SUPPORT_TIME) - 1e-9
        )
    assert abs(timed[-1].lift + timed[-1].land - 10.1) < 0.05


def test_steps_with_room_keep_their_times():
    moves = (Step("left_foot", 1.5, 2.1), Step("right_foot", 2.5, 3.2))
    assert retimed_steps(moves, [0.3, 0.3]) == tuple(
        Step(m.foot, pytest.approx(m.lift), pytest.approx(m.land)) for m in moves
    )


def hurried(length, small):
    """Ten steps in the time of five, after three seconds of none and before three more, in eight seconds of 50 Hz."""
    steps = [Step(f"{'left' if k % 2 else 'right'}_foot", 3.0 + 0.2 * k, 3.18 + 0.2 * k) for k in range(10)]
    times = np.arange(401) * 0.02
    return times, step_tempo([AskedStep(step, length, 0.3, omissible=small) for step in steps], times)


def test_time_is_stretched_only_where_steps_need_it():
    times, found = hurried(0.3, small=False)
    speed = np.diff(times) / np.diff(found.clock)
    assert len(found.steps) == 10
    assert speed.max() < 1.001 and 0.5 < speed.min() < 0.9
    assert (speed[:75] > 0.99).all() and (speed[-75:] > 0.99).all()
    assert np.abs(np.diff(speed)).max() < 0.1


def test_no_time_is_stretched_where_it_must_not_be():
    times = np.arange(401) * 0.02
    steps = [Step(f"{'left' if k % 2 else 'right'}_foot", 3.0 + 0.2 * k, 3.18 + 0.2 * k) for k in range(10)]
    found = step_tempo([AskedStep(step, 0.3, 0.3, omissible=False) for step in steps], times, max_slowness=1.0)
    np.testing.assert_array_equal(found.clock, times)
    assert len(found.steps) == 10


def test_small_steps_are_left_out_before_time_is_stretched():
    times, found = hurried(0.05, small=True)
    assert 3 <= len(found.steps) < 10
    np.testing.assert_allclose(found.clock, times, atol=1e-9)


def still(wanted):
    """A path of one piece that carries no stand anywhere, and its price."""
    return {foot: np.zeros((len(stands), 2, 1)) for foot, stands in wanted.items()}, np.eye(1)


def between(wanted, moves):
    """The places (steps, 2, 2) of a body over the middle between both feet, where steps begin and end."""
    middles = [
        0.5 * np.add(*((stand.x, stand.y) for stand in (wanted["left_foot"][left], wanted["right_foot"][right])))
        for left, right in standing_pairs(moves)
    ]
    return np.array(list(pairwise(middles)))


def test_a_path_is_scaled_where_its_strides_are_too_long(robot):
    """Two strides of 1.2 m after two of 0.2 m: the first piece of the path keeps its length, the second does not, and
    the footholds stay near their places along it."""
    reach = LegReach.of(robot)
    ahead = {"left_foot": [(0.0, 0.0), (0.2, 0.0), (0.4, 1.2)], "right_foot": [(0.0, 0.0), (0.4, 0.0), (0.4, 2.4)]}
    across = {"left_foot": 0.1, "right_foot": -0.1}
    wanted = {foot: [Foothold(a + b, across[foot], 0.0) for a, b in pieces] for foot, pieces in ahead.items()}
    carried = {foot: np.array([[list(piece), [0.0, 0.0]] for piece in pieces]) for foot, pieces in ahead.items()}
    moves = [Step(f"{side}_foot", k + 1.0, k + 1.6) for k, side in enumerate(("left", "right", "left", "right"))]
    turned, over = reachable_headings(wanted, moves, reach), between(wanted, moves)
    found, scales = reachable_footholds(wanted, turned, moves, reach, carried, 0.15**2 * np.eye(2), over)
    assert scales[0] > 0.9 and scales[1] < 0.5
    kept = reachable_footholds(wanted, turned, moves, reach, carried, 0.15**2 * np.eye(2), over, min_scale=1.0)
    np.testing.assert_array_equal(kept[1], 1.0)
    stride = abs(kept[0]["left_foot"][-1].x - kept[0]["right_foot"][-1].x)
    assert stride < reach.max_stride + 1e-6
    for foot, pieces in ahead.items():
        for stand, piece in zip(found[foot], pieces, strict=True):
            assert (
                np.hypot(stand.x - scales @ piece, stand.y - across[foot])
                < MAX_FOOTHOLD_OFFSET * reach.leg_length + 1e-6
            )


def test_a_foot_s_speed_counts_from_a_body_that_goes_along(robot):
    """Strides of 0.9 m in half a second: as far as the foot gets by itself, and as far again as the body gets."""
    reach = LegReach.of(robot)
    wanted = {
        "left_foot": [Foothold(x, 0.1, 0.0) for x in (0.0, 0.45, 1.35)],
        "right_foot": [Foothold(x, -0.1, 0.0) for x in (0.0, 0.9)],
    }
    moves = [Step("left_foot", 1.0, 1.5), Step("right_foot", 1.7, 2.2), Step("left_foot", 2.4, 2.9)]
    turned, over = reachable_headings(wanted, moves, reach), between(wanted, moves)
    travel = np.tile([[[0.25], [0.0]]], (3, 1, 1))
    alone, _ = reachable_footholds(wanted, turned, moves, reach, *still(wanted), over)
    along, scales = reachable_footholds(wanted, turned, moves, reach, *still(wanted), over, body_travel=travel)
    own = reach.swing_length(0.5)

    def stride(found):
        return found["right_foot"][1].x - found["right_foot"][0].x

    assert stride(alone) == pytest.approx(own, abs=1e-3)
    assert own + 0.05 < stride(along) < own + 0.25 * scales[0] + 1e-3


def test_of_two_feet_that_want_each_others_place_one_gets_it(robot):
    reach = LegReach.of(robot)
    wanted = {
        "left_foot": [Foothold(0.0, 0.1, 0.0), Foothold(0.0, -0.2, 0.0)],
        "right_foot": [Foothold(0.0, -0.1, 0.0), Foothold(0.0, 0.2, 0.0)],
    }
    moves = (Step("left_foot", 1.0, 1.6), Step("right_foot", 2.0, 2.6))
    found, _ = reachable_footholds(
        wanted, reachable_headings(wanted, moves, reach), moves, reach, *still(wanted), between(wanted, moves)
    )
    off = sorted(abs(found[foot][1].y - wanted[foot][1].y) for foot in wanted)
    assert off[0] < 0.15 < off[1]


def test_a_way_scaled_piece_by_piece_adds_up():
    human = walker()
    way = ScalablePath.of(human)
    count = way.carry.shape[2]
    place = np.cumsum(np.diff(way.carry.sum(axis=2), axis=0), axis=0)
    np.testing.assert_allclose(way.shift(np.ones(count)), 0.0, atol=1e-12)
    np.testing.assert_allclose(way.shift(np.full(count, 0.5))[1:], -0.5 * place, atol=1e-12)
    assert way.length_ratio(np.full(count, 0.5)) == pytest.approx(0.5)


def test_footholds_out_of_reach_are_moved_into_it(robot):
    reach = LegReach.of(robot)
    wanted = {
        "left_foot": [Foothold(0.0, 0.1, 0.0), Foothold(1.2, 0.1, 0.0), Foothold(1.2, 0.1, 2.0)],
        "right_foot": [Foothold(0.0, -0.1, 0.0), Foothold(1.2, 0.2, 0.0)],
    }
    moves = (Step("left_foot", 1.0, 1.5), Step("right_foot", 2.0, 2.5), Step("left_foot", 3.0, 3.5))
    turned = reachable_headings(wanted, moves, reach)
    found, _ = reachable_footholds(wanted, turned, moves, reach, *still(wanted), between(wanted, moves))
    for left, right in ((0, 0), (1, 0), (1, 1), (2, 1)):
        a, b = found["left_foot"][left], found["right_foot"][right]
        assert reach.toe_out_range[0] - 1e-6 < a.heading - b.heading < reach.toe_out_range[1] + 1e-6
        middle = 0.5 * (a.heading + b.heading)
        across = np.array([-np.sin(middle), np.cos(middle)])
        way = np.array([a.x - b.x, a.y - b.y])
        assert way @ across > min_ankle_separation((a.heading, b.heading), reach, across) - 1e-6
        assert np.linalg.norm(way - reach.hip_width * across) < reach.max_stride + 1e-6


def narrow_ankles(robot, degrees):
    """A robot whose feet roll by no more than that to either side."""
    lower, upper = robot.lower.copy(), robot.upper.copy()
    for leg in ("left_leg", "right_leg"):
        joint = robot.groups[leg][-1]
        lower[joint], upper[joint] = -np.deg2rad(degrees), np.deg2rad(degrees)
    return replace(robot, lower=lower, upper=upper)


def test_a_flat_foot_stands_where_the_leg_reaches_it(robot):
    """An ankle that rolls by 15° reaches tan 15° of the hip's height beside where it is below an upright leg."""
    narrow, outward = narrow_ankles(robot, 15.0), 0.035  # m, from HRP-2's hips to its ankles
    for row, height in enumerate(HIP_HEIGHTS_LEGS):
        for side, foot in (("left", 1.0), ("right", -1.0)):
            beside = flat_foot_distances(narrow, side)[
                row, DIRECTION_COUNT // 4 if foot > 0.0 else 3 * DIRECTION_COUNT // 4
            ]
            most = np.tan(np.deg2rad(15.0) - RANGE_MARGIN) * height * LegReach.of(robot).leg_length + outward
            assert 0.9 * most < beside < most + 1e-3
            assert flat_foot_distances(robot, side)[row].max() > 1.2 * beside


def test_feet_that_roll_little_stand_closer(robot):
    """Before a step, the other foot has to carry the body: the less feet roll, the closer they stand."""
    wanted = {
        "left_foot": [Foothold(0.0, 0.22, 0.0)],
        "right_foot": [Foothold(0.0, -0.22, 0.0), Foothold(0.1, -0.19, 0.0)],
    }
    moves = (Step("right_foot", 2.0, 3.4),)
    over_left = np.tile([0.0, 0.2], (1, 2, 1))
    apart = []
    for degrees in (35.0, 15.0, 1.0):
        reach = LegReach.of(narrow_ankles(robot, degrees))
        turned = reachable_headings(wanted, moves, reach)
        found, _ = reachable_footholds(wanted, turned, moves, reach, *still(wanted), over_left)
        apart.append([found["left_foot"][0].y - foothold.y for foothold in found["right_foot"]])
    assert min(apart[0]) > 0.3 and 0.2 < max(apart[1]) < 0.3
    assert min(apart[2]) > min_ankle_separation((0.0, 0.0), reach, np.array([0.0, 1.0])) - 1e-6


def test_feet_are_turned_until_legs_meet(robot):
    """With legs as they are HRP-2's hips set the limits; the thicker they are, the sooner knees meet over toes that are
    turned in."""
    limits = [LegReach.of(with_thick_legs(robot, more)).toe_out_range for more in (0.0, 0.012, 0.02)]
    assert limits[0] == LegReach.of(robot).toe_out_range
    assert limits[0][0] < limits[1][0] < limits[2][0] <= 0.0
    assert limits[0][1] == limits[1][1] == limits[2][1]


def test_feet_are_turned_out_until_heels_of_hips_meet(robot):
    """A box behind each thigh, which turns inward where toes turn out."""
    shapes = robot.shapes.copy()
    for shape in shapes.geometryObjects:
        if shape.name in ("RLEG2_LINK_0", "LLEG2_LINK_0"):
            shape.geometry = coal.Box(0.04, 0.04, 0.1)
            shape.placement = shape.placement * pin.SE3(np.eye(3), shape.placement.rotation.T @ [-0.15, 0.0, 0.0])
    least, most = LegReach.of(replace(robot, shapes=shapes)).toe_out_range
    assert least == LegReach.of(robot).toe_out_range[0]
    assert 0.0 < most < LegReach.of(robot).toe_out_range[1]


def test_footholds_in_reach_stay(robot):
    reach = LegReach.of(robot)
    wanted = {
        "left_foot": [Foothold(0.0, 0.1, 0.0), Foothold(0.2, 0.12, 0.1)],
        "right_foot": [Foothold(0.0, -0.1, 0.0)],
    }
    moves = (Step("left_foot", 1.0, 1.6),)
    found, _ = reachable_footholds(
        wanted, reachable_headings(wanted, moves, reach), moves, reach, *still(wanted), between(wanted, moves)
    )
    for foot, stands in wanted.items():
        for stand, own in zip(stands, found[foot], strict=True):
            assert (own.x, own.y, own.heading) == pytest.approx((stand.x, stand.y, stand.heading), abs=1e-9)


def test_a_high_lift_keeps_its_time_unless_another_foot_has_to_step_meanwhile():
    def asked(foot, lift, land, small):
        return AskedStep(Step(foot, lift, land), 0.1, 0.3, omissible=small, high=True)

    kick = asked("right_foot", 1.0, 2.0, False)
    pivot, step, later = (
        asked("left_foot", 1.4, 1.8, True),
        asked("left_foot", 1.8, 2.4, False),
        asked("left_foot", 2.0, 2.4, False),
    )
    assert with_time_kept(kick, [kick, pivot, later]).min_time == pytest.approx(KEPT_TIME_SHARE)
    assert with_time_kept(kick, [kick, pivot, step]) == kick


def test_the_dancers_footfalls_are_made(walk):
    falls = walk.travel.footfalls
    assert len(falls) == 6 and all(fall.landed is not None for fall in falls)
    assert walk.travel.scale > 0.9
    for fall in falls:
        row = round((fall.landed + 0.1) * walk.motion.rate)
        place = walk.motion.track(fall.foot.replace("foot", "ankle")).position[row, :2]
        assert np.linalg.norm(place - fall.place) < 0.05


def test_auto_plants_feet_that_never_move(robot, walk):
    still = plan(dancer(), robot, "auto", rate=500.0)
    assert still.travel is None and len(still.motion.phases) == 1
    np.testing.assert_allclose(still.motion.q[0], robot.rest, atol=1e-4)


def test_a_slower_course_makes_the_same_steps_later(robot, walk):
    """Twice as slow about 3 s: places and footfalls stay, times do not, and no swing or stance gets shorter."""
    going = walk.travel
    times = going.human.times
    clock = clock_from_slowness(1.0 + (np.abs(times - 3.0) < 0.5), 1.0 / going.human.rate)
    slow = travel_at_clock(going, clock)
    assert slow.stands == going.stands and len(slow.footfalls) == len(going.footfalls)
    edges = np.array([(step.lift, step.land) for step in going.steps]).ravel()
    later = np.array([(step.lift, step.land) for step in slow.steps]).ravel()
    np.testing.assert_allclose(later, np.interp(edges, times, clock), atol=0.01)
    assert (np.diff(later) > np.diff(edges) - 1e-9).all() and later[-1] > edges[-1] + 0.5
    assert slow.human.duration == pytest.approx(clock[-1])


def test_a_clock_runs_slower_by_whole_frames_and_only_where_it_should():
    """What lies between two slow places is sampled where it was, only later."""
    dt = 0.02
    times = dt * np.arange(500)
    slow = np.ones(500)
    slow[100:140], slow[300:350] = 1.3, 1.7
    clock = clock_from_slowness(slow, dt)
    frames = (clock - times) / dt
    assert np.all(np.diff(clock) > dt * (1.0 - 1e-9))
    for rows, least in ((times < 0.9, 0.0), ((times > 3.9) & (times < 4.9), 12.0), (times > 8.1, 12.0 + 35.0)):
        np.testing.assert_allclose(frames[rows], np.ceil(frames[rows][0] - 1e-6), atol=1e-6)
        assert least - 1e-6 <= frames[rows][0] <= least + 2.0
    assert np.diff(clock)[325] / dt == pytest.approx(1.7, abs=0.1)
    np.testing.assert_array_equal(clock_from_slowness(np.ones(500), dt), times)


def test_given_contacts_are_made(robot):
    feet = ("left_foot", "right_foot")
    steps = tuple(Step(feet[k % 2], 0.8 * k + 0.36, 0.8 * k + 0.96) for k in range(6))
    motion = plan(walker(), robot, "steps", rate=500.0, contacts=steps).motion
    swings = [phase for phase in motion.phases if len(phase.feet) == 1]
    assert [(next(iter(swing.feet)), swing.start, swing.end) for swing in swings] == [
        (feet[(k + 1) % 2], pytest.approx(step.lift + 1.0), pytest.approx(step.land + 1.0))
        for k, step in enumerate(steps)
    ]


def test_planted_feet_take_no_contacts(robot):
    with pytest.raises(InputError, match="planted feet make no steps"):
        plan(walker(), robot, "planted", contacts=())


def test_feet_carry_after_a_ramp(walk, robot):
    """While a foot is loaded or unloaded the ZMP has to be under the other one."""
    phases = walk.motion.phases
    swing = next(k for k, phase in enumerate(phases) if len(phase.feet) == 1)
    carried = supports(robot, phases)
    alone = next(support for support in carried if support.polygon.vertices.shape[0] == 4 and support.start > 0.0)
    assert alone.start == pytest.approx(phases[swing].start - FORCE_RAMP_TIME)


@pytest.mark.skipif(not MOCAP.is_dir(), reason="needs ../shared/mocap")
def test_a_recorded_walk_can_be_stepped(robot):
    assert_can_be_stepped(plan(recognise(read(MOCAP / "bandai_walk.bvh")), robot, "steps", rate=500.0).motion)


def test_a_dancer_that_turns_round_keeps_its_chest_over_its_feet(robot):
    """The chest's turn counts from the feet: half a turn of the whole body is none of the chest."""
    build = Build.of(robot)
    human = human_on_time_line(human_over_feet(dancer(), build), 50.0)
    half = np.diag([-1.0, -1.0, 1.0])
    turned = replace(human, frames={body: half @ rotation for body, rotation in human.frames.items()})
    straight = targets_of_human(human, robot, build, np.zeros(human.count)).frames["chest"][-1]
    round_about = targets_of_human(turned, robot, build, np.full(human.count, np.pi)).frames["chest"][-1]
    np.testing.assert_allclose(half @ straight, round_about, atol=1e-9)


def test_a_foot_comes_down_more_gently_than_it_goes_up():
    share = np.linspace(0.0, 1.0, 2001)
    height = _height_profile(share)
    assert height.max() == pytest.approx(1.0, abs=1e-6)
    assert height[[0, -1]].tolist() == [0.0, 0.0]
    bend = np.diff(height, 2) / share[1] ** 2
    assert np.abs(bend).max() == pytest.approx(HEIGHT_PROFILE_CURVATURE, rel=1e-2)
    assert np.abs(bend[[0, -1]]).max() < 0.02 * HEIGHT_PROFILE_CURVATURE
    near = share < 0.1
    assert np.all(height[::-1][near] <= height[near]) and height[::-1][near].max() < 0.5 * height[near].max()
