"""Following: a stream becomes a reference within limits, and what befalls the stream does not make it jump."""

from dataclasses import replace

import numpy as np
import pytest

from sim.reporting.figures import Points
from sot.errors import InputError, UnknownSkeletonError
from sot.live.clip_source import ClipSource
from sot.live.follower import EASE_OUT_TIME, STALE_TIME, Follower
from sot.live.sensing.key_point_source import KeyPointSource
from sot.motion.human.capture import Capture
from sot.motion.human.skeleton import named_joints
from sot.motion.likeness import UPPER_SEGMENTS, mean_segment_angle_deg
from sot.robots.robot import Robot
from tests.sot.live.people import Spoilt, groove, moved

STEP = 0.01


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def follow(source, robot, seconds, delay=0.0):
    follower = Follower(source, robot, delay)
    for k in range(round(seconds / STEP)):
        follower.update(k * STEP)
    return follower


def largest_acceleration_step(follower):
    legs = 6 + np.array(follower.robot.groups["legs"])
    curves = np.delete(np.array([knot.ddy for knot in follower.reference._knots]), legs, axis=1)
    return np.abs(np.diff(curves, axis=0)).max()


def test_it_follows_within_all_limits(robot):
    follower = follow(groove(), robot, 4.0)
    motion = follower.reference.recorded(3.9, 100.0)
    assert follower.counts["persons"] == 1
    assert (motion.q[:, 7:] >= robot.lower).all() and (motion.q[:, 7:] <= robot.upper).all()
    assert (np.abs(motion.v[:, 6:]) <= robot.velocity).all()
    assert np.abs(motion.q[-1, 7:] - robot.rest[7:]).max() > 0.1


def test_a_reference_answers_what_a_motion_made_of_it_answers(robot):
    follower = follow(groove(), robot, 3.0)
    live, motion = follower.reference, follower.reference.recorded(2.95, 500.0)
    for t in (1.234, 2.5, 2.718):
        for one, other in zip(live.joints(t), motion.joints(t), strict=True):
            assert one == pytest.approx(other, abs=1e-3)
        for one, other in zip(live.balance(t), motion.balance(t), strict=True):
            assert one == pytest.approx(other, abs=2e-3)
        pose, wanted = live.pose("head")(t), motion.pose("head")(t)
        assert pose.position == pytest.approx(wanted.position, abs=1e-3)
        assert pose.velocity == pytest.approx(wanted.velocity, abs=2e-2)
    assert live.feet.keys() == motion.feet.keys()


def test_the_feet_of_the_reference_stay(robot):
    motion = follow(groove(), robot, 5.0).reference.recorded(4.9, 50.0)
    for foot in robot.feet:
        track = motion.track(foot)
        assert np.abs(track.position - track.position[0]).max() < 2e-3
        assert np.abs(track.velocity).max() < 0.02


def test_a_delay_lets_arms_start_early(robot):
    """Mean angle of the arms' segments to those of the person who is played, who moves three times too fast."""
    clip = groove(60.0)._frames
    fast = Capture("fast", 180.0, clip.joints, clip.parents, clip.positions, clip.rotations)

    def error(delay):
        follower = follow(ClipSource(fast, 50.0), robot, 3.4 + delay, delay)
        motion = follower.reference.recorded(3.3 + delay, 100.0)
        played = [(t, targets) for t, targets in follower.shown if 2.0 + delay < t < 3.2 + delay]
        human = {name: np.array([targets.points[name] for _, targets in played]) for name in played[0][1].points}
        q = motion.q[[round(t * motion.rate) for t, _ in played]]
        return mean_segment_angle_deg(human, Points.of(robot, q, tuple(human)).positions, UPPER_SEGMENTS)

    assert error(0.4) < 0.75 * error(0.0)


def test_a_stream_that_stops_is_left_within_a_third_of_a_second(robot):
    stop = 3.0
    source = Spoilt(lambda frame, now: [frame] if now < stop else [])
    follower = follow(source, robot, stop + STALE_TIME + EASE_OUT_TIME + 0.9)
    assert STALE_TIME <= 0.3 and STALE_TIME + EASE_OUT_TIME < 2.5
    assert np.abs(follower.reference.now[6:] - robot.rest[7:]).max() < 0.02
    assert follower.held_s > 1.0
    assert largest_acceleration_step(follower) < 25.0


SPOILS = {
    "lost": lambda frame, now: [] if frame.sequence % 4 == 0 else [frame],
    "doubled": lambda frame, now: [frame, frame],
    "not numbers": lambda frame, now: [
        replace(frame, positions=np.full_like(frame.positions, np.nan)) if frame.sequence % 3 == 0 else frame
    ],
    "gap": lambda frame, now: [] if 2.5 < now < 3.0 else [frame],
    "pelvis jump": lambda frame, now: [moved(frame, [0.7, 0.0, 0.0]) if now > 3.0 else frame],
    "a frame elsewhere": lambda frame, now: [moved(frame, [0.0, 2.0, 0.0]) if frame.sequence == 150 else frame],
    "absurd": lambda frame, now: [replace(frame, positions=3.0 * frame.positions) if frame.sequence > 150 else frame],
}


@pytest.mark.parametrize("spoil", SPOILS)
def test_what_befalls_frames_does_not_make_the_reference_jump(robot, spoil):
    follower = follow(Spoilt(SPOILS[spoil]), robot, 4.5)
    motion = follower.reference.recorded(4.4, 100.0)
    assert np.isfinite(motion.q).all()
    assert (np.abs(motion.v[:, 6:]) <= robot.velocity).all()
    assert largest_acceleration_step(follower) < 25.0


def test_left_and_right_swapped_are_not_believed(robot):
    def swap(frame, now):
        if not 150 <= frame.sequence < 160:
            return [frame]
        names = frame.skeleton.joints
        other = [
            names.index(name.replace("Left", "#").replace("Right", "Left").replace("#", "Right")) for name in names
        ]
        return [replace(frame, positions=frame.positions[other], rotations=frame.rotations[other])]

    follower = follow(Spoilt(swap), robot, 4.0)
    assert follower.counts["jump"] == 10 and follower.counts["jump believed"] == 0


def test_a_person_elsewhere_is_believed_after_a_while(robot):
    follower = follow(Spoilt(SPOILS["pelvis jump"]), robot, 4.5)
    assert follower.counts["jump believed"] == 1
    assert follower.counts["jump"] < 20


def renamed_groove():
    """The clip under names that nobody knows, and those that it is known by."""
    clip = groove()._frames
    names = tuple(f"bone{k}" for k in range(len(clip.joints)))
    return Capture("renamed", 50.0, names, clip.parents, clip.positions, clip.rotations), named_joints(clip)


def test_an_unknown_skeleton_says_what_it_has_and_lacks_and_takes_a_mapping(robot):
    clip, known = renamed_groove()
    with pytest.raises(UnknownSkeletonError, match=r"not found: head, left_hip, .* its joints are bone0") as refused:
        follow(ClipSource(clip, 50.0), robot, 0.1)
    assert 'head = ""' in refused.value.mapping
    mapping = {joint: [f"bone{index}"] for joint, index in known.items()}
    for source in (ClipSource(clip, 50.0), KeyPointSource(ClipSource(clip, 50.0), mapping=mapping)):
        follower = Follower(source, robot, mapping=mapping)
        for k in range(130):
            follower.update(k * STEP)
        assert follower.counts["persons"] == 1 and follower.shown


def test_positions_alone_are_enough(robot):
    source = Spoilt(lambda frame, now: [replace(frame, rotations=None)])
    follower = follow(source, robot, 3.0)
    assert follower.counts["persons"] == 1 and len(follower.shown) > 50


def test_the_upper_body_alone_is_enough(robot):
    follower = follow(KeyPointSource(groove()), robot, 3.0)
    assert follower.counts["persons"] == 1 and len(follower.shown) > 50
    assert follower.shown[-1][1].frames["chest"][2, 2] > 0.9


def test_some_key_points_are_not_enough():
    with pytest.raises(InputError, match="missing: left_elbow"):
        KeyPointSource(groove(), ("waist", "left_wrist", "right_wrist", "left_shoulder", "right_shoulder", "head"))
