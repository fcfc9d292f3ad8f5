"""What is said of a sway, on swaying that is known; one push under physics, with and without damping."""

import numpy as np
import pytest

from scenarios.kimoh2013.damping.push_runs import Sway, pushed, series_of, usual_push
from scenarios.kimoh2013.damping.push_view import draw_sways
from scenarios.kimoh2013.damping.pushes import controllers_of
from scenarios.kimoh2013.damping.stance import stance_of, usual_compliance
from sot.robots.robot import Robot
from sot.servo.identified import identified_robots, read_identified


def decaying(ratio: float, frequency: float = 1.5) -> Sway:
    t = np.arange(-100, 1000) / 200.0
    omega = 2.0 * np.pi * frequency
    turning = omega * np.sqrt(1.0 - ratio**2)
    zmp = 0.08 * np.exp(-ratio * omega * t) * np.cos(turning * t)
    return Sway(t, np.where(t < 0.0, 0.0, zmp), None)


@pytest.mark.parametrize("ratio", [0.05, 0.3, 0.5, 0.72])
def test_damping_ratio_of_a_known_sway(ratio):
    assert decaying(ratio).damping_ratio(1.3) == pytest.approx(ratio, abs=0.02)


def test_settling_time_and_swing_back_of_a_known_sway():
    sway = decaying(0.3)
    omega = 2.0 * np.pi * 1.5
    assert np.all(np.abs(sway.zmp[sway.time >= sway.settling_time]) <= 0.005)
    assert sway.settling_time == pytest.approx(np.log(0.08 / 0.005) / (0.3 * omega), abs=0.4)
    peak = np.exp(-0.3 / np.sqrt(1.0 - 0.09) * (np.pi - np.arctan(0.3 / np.sqrt(1.0 - 0.09))))
    assert sway.swing_back == pytest.approx(peak * np.sqrt(1.0 - 0.09), abs=0.02)


def test_a_robot_that_fell_never_settles():
    assert Sway(np.arange(3.0), np.zeros(3), 1.0).settling_time == np.inf


def test_a_series_of_pushes_is_the_same_one_after_each_period():
    push = usual_push(stance_of(Robot.load("hrp2"), "double"), 0, 3)
    series = series_of(push, 3, 0.7)
    assert [one.t - push.t for one in series] == pytest.approx([0.0, 0.7, 1.4])
    assert {(one.force, one.duration, one.body) for one in series} == {(push.force, push.duration, push.body)}


def test_controllers_and_their_order():
    identified = read_identified(identified_robots()["hrp2"])
    found = controllers_of(identified, (0.3, 0.72), "filtered")
    assert [one.name for one in found] == ["none", "0.3", "0.72", "paper"]
    assert found[0].planes is None
    assert min(found[2].margins.values()) > 0.5
    assert set(found[3].margins.values()) == {-1.0}


def test_picture(tmp_path):
    draw_sways(tmp_path / "pushes.svg", "robot", {"xz-double": {"none": decaying(0.05), "0.72": decaying(0.72)}})
    assert (tmp_path / "pushes.svg").read_text().count("polyline") >= 2


@pytest.mark.slow
def test_damping_settles_a_push_that_sways_on_without():
    robot = Robot.load("hrp2")
    stance, compliance = stance_of(robot, "double"), usual_compliance(robot)
    none, damped, paper = (
        controllers_of(read_identified(identified_robots()["hrp2"]), (0.72,), "filtered")[k] for k in range(3)
    )
    push = usual_push(stance, 0, 0)
    free = pushed(stance, compliance, none.planes, [push], 3.0, 0)
    calm = pushed(stance, compliance, damped.planes, [push], 2.0, 0)
    assert free.settling_time > 2.5
    assert free.swing_back > 0.6
    assert calm.settling_time < 0.7
    assert calm.damping_ratio(1.5) == pytest.approx(0.72, abs=0.2)
    assert pushed(stance, compliance, paper.planes, [push], 2.0, 0).fell_at is not None


@pytest.mark.slow
def test_pushes_in_its_own_period_shake_up_a_robot_that_nothing_damps():
    robot = Robot.load("hrp2")
    stance, compliance = stance_of(robot, "double"), usual_compliance(robot)
    identified = read_identified(identified_robots()["hrp2"])
    none, damped = controllers_of(identified, (0.72,), "filtered")[:2]
    period = 2.0 * np.pi / identified.cases["xz", "double"].pendulum.natural_frequency
    pushes = series_of(usual_push(stance, 0, 0), 3, period)

    def peak(planes):
        once, series = (pushed(stance, compliance, planes, some, 1.0, 0) for some in (pushes[:1], pushes))
        assert once.fell_at is None and series.fell_at is None
        return [np.abs(sway.zmp[sway.time >= 0.0]).max() for sway in (once, series)]

    once, series = peak(none.planes)
    assert series > 1.3 * once
    once, series = peak(damped.planes)
    assert series < 1.1 * once
