"""Feet that yield, on springs."""

import numpy as np
import pytest

from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.servo.admittance import AdmittanceGains, FootAdmittance
from sot.servo.load_sharing import FootLoad

STIFFNESS = np.array([2500.0, 1800.0, 2e5])
PERIOD = 0.001


def settled(gains, wanted, seconds=3.0):
    """What feet on springs carry after some time, and the share of the lack that is gone after each tick."""
    robot = Robot.load("hrp2")
    admittance = FootAdmittance(robot, 0.8, gains, 0.0, PERIOD)
    measured, gone = {foot: np.array([0.0, 0.0, 280.0, 0.0, 0.0, 0.0]) for foot in wanted}, []
    for _ in range(round(seconds / PERIOD)):
        for foot, offset in admittance(wanted, measured, dict.fromkeys(robot.feet, 1.0 / STIFFNESS)).items():
            if foot in wanted:
                measured[foot][2] = 280.0 - STIFFNESS[2] * offset[2]
                measured[foot][3:5] = -STIFFNESS[:2] * offset[:2]
        gone.append(measured["left_foot"][4] / wanted["left_foot"].moment[1])
    return measured, np.array(gone)


WANTED = {
    "left_foot": FootLoad(np.array([0.0, 0.0, 330.0]), np.array([8.0, -12.0, 0.0])),
    "right_foot": FootLoad(np.array([0.0, 0.0, 230.0]), np.array([-3.0, 5.0, 0.0])),
}


def test_without_a_leak_the_feet_come_to_carry_what_they_are_to():
    measured, _ = settled(AdmittanceGains(leak=0.0, leg=2.0), WANTED)
    for foot, load in WANTED.items():
        np.testing.assert_allclose(measured[foot][3:5], load.moment[:2], atol=1e-3)
        assert measured[foot][2] == pytest.approx(load.force[2], abs=0.1)


def test_the_moment_comes_about_at_the_rate_of_the_gain():
    _, gone = settled(AdmittanceGains(ankle=3.0, leak=0.0), WANTED, 1.0)
    rate = 3.0 * np.sqrt(GRAVITY / 0.8)
    t = PERIOD * np.arange(1, len(gone) + 1)
    np.testing.assert_allclose(gone, 1.0 - np.exp(-rate * t), atol=0.01)


def test_a_leak_leaves_its_share_of_the_lack():
    _, gone = settled(AdmittanceGains(ankle=3.0, leak=0.3), WANTED)
    assert gone[-1] == pytest.approx(3.0 / 3.3, rel=1e-2)


def test_one_foot_alone_does_not_grow():
    measured, _ = settled(AdmittanceGains(), {"left_foot": WANTED["left_foot"]}, 0.5)
    assert measured["left_foot"][2] == 280.0


def moments_on_damped_bushes(filtered_by, seconds=1.0, period=0.005, relaxation=0.01):
    """Moment of a foot on a bush K (φ + t_r φ̇) behind a servo that goes in a straight line from command to command,
    each of them one period ahead; as a share of the moment that is wanted."""
    robot, wanted = Robot.load("hrp2"), {"left_foot": FootLoad(np.array([0.0, 0.0, 560.0]), np.array([0.0, 10.0, 0.0]))}
    admittance = FootAdmittance(robot, 0.8, AdmittanceGains(ankle=9.0, leak=0.0), filtered_by, period)
    command, angle, moments = 0.0, 0.0, [0.0]
    for _ in range(round(seconds / period)):
        measured = {"left_foot": np.array([0.0, 0.0, 560.0, 0.0, moments[-1], 0.0])}
        pitch = admittance(wanted, measured, dict.fromkeys(robot.feet, 1.0 / STIFFNESS))["left_foot"][1]
        reached = pitch + (pitch - command)
        moments.append(-STIFFNESS[1] * (reached + relaxation * (reached - angle) / period))
        command, angle = pitch, reached
    return np.array(moments) / 10.0


def test_dampers_of_the_bushes_do_not_make_fast_servos_shake():
    assert np.abs(moments_on_damped_bushes(0.0)).max() > 10.0
    calm = moments_on_damped_bushes(0.01)
    assert calm.max() < 1.3
    np.testing.assert_allclose(calm[-40:], 1.0, atol=0.01)
