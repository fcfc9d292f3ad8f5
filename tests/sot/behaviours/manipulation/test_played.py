"""What a clock that pauses has played: a motion whose velocities are those of its places, and whose feet stand when."""

import numpy as np
import pytest

from sot.behaviours.manipulation.clock import DemonstrationClock
from sot.behaviours.manipulation.played import played_motion
from sot.motion import Motion
from sot.motion.objects.events import ContactSets
from sot.robots import Robot

RATE = 200.0
CLOCK_RATE = 20.0


@pytest.fixture(scope="module")
def swaying():
    """A motion whose chest turns to and fro, whose pelvis goes forwards, and whose centre of mass rises and falls."""
    robot = Robot.load("hrp2")
    motion = Motion.standing(robot, 4.0, RATE)
    t = np.arange(len(motion.q)) / RATE
    chest = robot.joints.index("CHEST0")
    q, v, a = motion.q.copy(), motion.v.copy(), motion.a.copy()
    q[:, 7 + chest], v[:, 6 + chest], a[:, 6 + chest] = 0.2 * np.sin(t), 0.2 * np.cos(t), -0.2 * np.sin(t)
    q[:, 0], v[:, 0], a[:, 0] = q[:, 0] + 0.01 * t, 0.01, 0.0
    com, climb = motion.com.copy(), motion.com_velocity.copy()
    com[:, 2], climb[:, 2] = com[:, 2] + 0.05 * np.sin(t), 0.05 * np.cos(t)
    fields = {name: getattr(motion, name) for name in ("com_acceleration", "zmp", "momentum", "phases")}
    return Motion(robot=robot, rate=RATE, q=q, v=v, a=a, com=com, com_velocity=climb, **fields)


@pytest.fixture(scope="module")
def played(swaying):
    clock, rows = DemonstrationClock(CLOCK_RATE), []
    for k in range(800):
        clock.running = not 200 <= k < 500
        clock.advance(k / RATE)
        rows.append((clock.time, clock.rate, clock.acceleration))
    led = np.zeros((800, 3, 2))
    led[:, 0, 1] = np.linspace(0.0, 0.1, 800)
    both, left = (sets(*feet) for feet in (("left_foot", "right_foot"), ("left_foot",)))
    history = [(0.0, both), (1.0, both), (1.5, left), (3.0, both), (799 / RATE, both)]
    return np.array(rows), led, played_motion(swaying, np.array(rows), led, history, RATE)


def sets(*feet):
    return ContactSets(frozenset(feet), frozenset(), frozenset(), frozenset())


def test_it_is_the_motion_at_the_clocks_times(swaying, played):
    clock, _, motion = played
    assert len(motion.q) == len(clock)
    for row in (0, 150, 260, 499, 799):
        np.testing.assert_allclose(motion.q[row], swaying.sample(clock[row, 0]).q, atol=1e-12)
    pause = slice(300, 500)
    assert np.ptp(motion.q[pause], axis=0).max() < 1e-5 and np.abs(motion.v[pause]).max() < 1e-4


def test_velocities_and_accelerations_are_those_of_its_places(played):
    _, _, motion = played
    middle = slice(1, -1)
    speed = (motion.q[2:, 7:] - motion.q[:-2, 7:]) * RATE / 2.0
    np.testing.assert_allclose(motion.v[middle, 6:], speed, atol=2e-3)
    np.testing.assert_allclose(
        motion.a[middle, 6:], np.gradient(motion.v[:, 6:], 1.0 / RATE, axis=0)[middle], atol=0.07
    )
    climb = np.gradient(motion.com[:, 2], 1.0 / RATE)
    np.testing.assert_allclose(motion.com_velocity[middle, 2], climb[middle], atol=2e-3)


def test_over_the_floor_the_centre_of_mass_is_the_led_one(played):
    _, led, motion = played
    np.testing.assert_array_equal(motion.com[:, :2], led[:, 0])
    np.testing.assert_array_equal(motion.zmp, led[:, 0])


def test_phases_follow_the_feet_that_stood_and_join_where_nothing_changed(played):
    _, _, motion = played
    told = [(phase.start, pytest.approx(phase.end), set(phase.feet)) for phase in motion.phases]
    both = {"left_foot", "right_foot"}
    assert told == [(0.0, 1.5, both), (1.5, 3.0, {"left_foot"}), (3.0, 799 / RATE, both)]
