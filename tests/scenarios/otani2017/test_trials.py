"""Trials with boxes: what counts as handled, and when heavier ones end."""

from types import SimpleNamespace

import numpy as np
import pytest

from scenarios.otani2017 import trials
from scenarios.replay import Replay
from sot.robots.robot import Robot


@pytest.fixture
def played(monkeypatch):
    """Runs that are told, not made: what `perform` and `object_report` answer."""
    robot, asked = Robot.load("hrp2"), []
    told = SimpleNamespace(failure=lambda mass: "", fell=None, error=0.002, tilt=0.1)

    def perform(request, handling, tell):
        asked.append(handling)
        log = SimpleNamespace(torque=0.5 * np.tile(robot.effort, (4, 1)))
        log.torque[1, 3] = robot.effort[3]
        ended = SimpleNamespace(log=SimpleNamespace(trimmed=lambda: log), fell_at_s=told.fell, reason="the waist sank")
        schedule = SimpleNamespace(failure=told.failure(handling.actual.mass), demonstration=None)
        return SimpleNamespace(run=ended), schedule, SimpleNamespace(robot=robot)

    def report(log, system, demonstration):
        box = {"mass_kg": asked[-1].actual.mass, "slip_max_m": 1e-3, "lifted_max_m": 0.2}
        return {"box": box | {"end_error_m": told.error, "end_tilt_deg": told.tilt}}

    monkeypatch.setattr(trials, "perform", perform)
    monkeypatch.setattr(trials, "object_report", report)
    return told, asked


def test_heavier_boxes_end_with_the_first_that_is_not_handled(played):
    told, _ = played
    told.failure = lambda mass: "box was lost at 3.00 s" if mass > 5.0 else ""
    done = list(trials.heavier_boxes(Replay("otani"), 2.0, 2.0))
    assert [one.mass for one in done] == [2.0, 4.0, 6.0]
    assert [one.failure for one in done] == ["", "", "box was lost at 3.00 s"]
    assert done[0].saturated == pytest.approx(0.25) and done[0].joint_loads[0] == (Robot.load("hrp2").joints[3], 1.0)
    assert "handled" in str(done[0]) and "box was lost" in str(done[2])


@pytest.mark.parametrize(
    ("change", "failure"),
    [
        ({"fell": 4.2}, "the robot fell at 4.2 s, the waist sank"),
        ({"error": 0.04}, "the box does not stand where it should"),
        ({"tilt": 8.0}, "the box does not stand where it should"),
    ],
)
def test_what_is_not_handled_says_why(played, change, failure):
    told, _ = played
    for name, value in change.items():
        setattr(told, name, value)
    assert next(trials.heavier_boxes(Replay("otani"), 2.0, 2.0)).failure == failure


def test_noise_counts_the_seeds_that_were_handled(played, capsys):
    _, asked = played
    trials.noise(mass=3.6, told=3.0, seeds=3)
    assert [(one.seed, one.actual.mass, one.believed.mass) for one in asked] == [(k, 3.6, 3.0) for k in (1, 2, 3)]
    assert capsys.readouterr().out.endswith("3 of 3 handled\n")


def test_a_step_of_nothing_is_told(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["trials", "heaviest", "--step", "0"])
    assert trials.main() == 2
    assert capsys.readouterr().err == "--first and --step must be above 0 kg\n"
