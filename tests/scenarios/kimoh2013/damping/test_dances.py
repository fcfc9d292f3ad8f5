"""Dances on servos: which controllers are compared, and what a row of the table is of."""

from dataclasses import asdict

import numpy as np
import pytest
from rich.console import Console

from scenarios.kimoh2013.damping import dances
from scenarios.replay import Replay
from sot.errors import InputError
from sot.hardware.compliance import FootCompliance
from sot.hardware.servo import JointTargets
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.stabiliser import DcmGains

SOFT = FootCompliance(2500.0, 2500.0, 2.4e5)


@pytest.fixture(scope="module")
def stand():
    return Motion.standing(Robot.load("hrp2"), 0.3, 500.0)


def numbers(gains):
    feet = asdict(gains)
    return np.array([feet["convergence"], *feet["feet"].values()])


def test_each_gain_is_changed_alone(monkeypatch, stand):
    made = []
    monkeypatch.setattr(dances, "Stabiliser", lambda motion, period, compliance, servo, dcm: made.append(numbers(dcm)))
    for make in dances.gain_changes(stand, SOFT, 0.002).values():
        make()
    usual = numbers(DcmGains())
    np.testing.assert_array_equal(made[0], usual)
    changes = sorted(tuple(gains / usual) for gains in made[1:])
    assert changes == sorted(
        tuple(np.where(np.arange(4) == k, share, 1.0)) for k in range(4) for share in dances.GAIN_SHARES
    )


def test_a_row_says_how_a_run_ended_and_how_far_it_was_off(stand):
    controllers = dances.stabilisers(stand, SOFT, 0.002, None)
    assert list(controllers) == ["open", "sag", "dcm", "dcm + sag"]
    figures = dances.controller_figures(stand, SOFT, {"sag": controllers["sag"]}, lambda words, share: None)
    assert figures["sag"]["fell_at_s"] is None
    assert 0.0 < figures["sag"]["zmp_rms_m"] < 0.03 and figures["sag"]["com_off_at_end_m"] < 0.01
    console = Console(record=True, width=100)
    fallen = {"fell_at_s": 1.23, "zmp_rms_m": 0.1, "com_off_at_end_m": 0.3}
    dances.print_dances({**figures, "open": fallen}, console)
    text = console.export_text()
    assert "fell at 1.2 s" in text and "upright" in text


def test_a_robot_that_falls_is_told_with_when():
    stand = Motion.standing(Robot.load("hrp2"), 2.0, 500.0)
    leaning = stand.robot.rest[7:].copy()
    leaning[[stand.robot.joints.index(name) for name in ("RLEG4", "LLEG4")]] -= 0.4  # onto its heels, and over

    class Leaning:
        period = 0.002

        def __call__(self, t, q, v, readings):
            return JointTargets(leaning, np.zeros(len(leaning)))

    figures = dances.controller_figures(stand, SOFT, {"leaning": Leaning}, lambda words, share: None)
    assert 0.2 < figures["leaning"]["fell_at_s"] < 2.0
    assert np.isfinite([figures["leaning"]["zmp_rms_m"], figures["leaning"]["com_off_at_end_m"]]).all()


def test_feet_too_soft_for_the_dance_are_refused():
    request = Replay("groove", duration=0.5, rate=200.0)
    with pytest.raises(InputError, match="cannot hold the robot up"):
        dances.dance_figures(request, "gains", FootCompliance(150.0, 2500.0), None, 0.72, lambda words, share: None)
