"""What is said of a sway, on swaying that is known; one push under physics, with and without damping."""

import numpy as np
import pytest

from scenarios.kimoh2013.damping.push_runs import Sway, pushed, usual_push
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
    free = pushed(stance, compliance, none.planes, push, 3.0, 0)
    calm = pushed(stance, compliance, damped.planes, push, 2.0, 0)
    assert free.settling_time > 2.5
    assert free.swing_back > 0.6
    assert calm.settling_time < 0.7
    assert calm.damping_ratio(1.5) == pytest.approx(0.72, abs=0.2)
    assert pushed(stance, compliance, paper.planes, push, 2.0, 0).fell_at is not None
