"""A dance on servos, open loop: upright on rigid feet and firm rubber, wherever on earth; on soft rubber it falls."""

from dataclasses import replace

import numpy as np
import pytest

from scenarios import cli
from scenarios.replay import Dance, Replay, dance, run_on_servos
from sim.log import FOOT_OFF
from sim.push import Push
from sim.reporting.figures import zmp
from sot.hardware import FootCompliance
from sot.robots.models import hrp2
from sot.servo import Stabiliser
from tests.sot.robots import variants

REQUEST = Replay(
    "groove", duration=5.0, rate=500.0, plant="servo", compliance=FootCompliance(2500.0, 2500.0), stabiliser="open"
)


def tell(what: str, share: float | None) -> None:
    pass


@pytest.fixture(scope="module")
def on_rubber() -> Dance:
    return dance(REQUEST, tell)


def zmp_error(danced: Dance) -> float:
    return zmp(danced.run.log.trimmed(), danced.motion)["rms_to_planned_m"]


@pytest.mark.slow
def test_it_rocks_on_rubber_and_hardly_on_rigid_feet(on_rubber):
    motion = on_rubber.motion
    rigid = run_on_servos(replace(REQUEST, compliance=None), Stabiliser(motion, 0.002), motion, None, tell)
    assert on_rubber.run.fell_at_s is None and rigid.run.fell_at_s is None
    assert zmp_error(rigid) < 0.03
    assert 0.04 < zmp_error(on_rubber) < 0.10


@pytest.mark.slow
def test_figures_100_m_away_and_turned_are_the_same(on_rubber):
    far = on_rubber.motion.placed(60.0, 80.0, np.deg2rad(137.0))
    there = run_on_servos(REQUEST, Stabiliser(far, 0.002), far, None, tell)
    assert there.run.fell_at_s is None
    assert zmp_error(there) == pytest.approx(zmp_error(on_rubber), rel=0.05)


@pytest.mark.slow
def test_the_rubber_of_hrp2_lets_an_open_loop_fall(on_rubber):
    soft, motion = replace(REQUEST, compliance=FootCompliance(707.0, 502.0)), on_rubber.motion
    fell_at = run_on_servos(soft, Stabiliser(motion, 0.002), motion, None, tell).run.fell_at_s
    assert fell_at is not None and fell_at > 2.0


@pytest.mark.slow
def test_a_push_that_feet_cannot_hold_is_caught_by_a_step():
    asked = replace(REQUEST, duration=4.0, compliance=FootCompliance(2430.0, 2430.0, 124570.0))
    pushed = replace(asked, pushes=(Push(2.0, (-280.0, 0.0, 0.0), 0.1, "chest"),))
    assert dance(replace(pushed, stabiliser="dcm"), tell).run.fell_at_s is not None
    caught = dance(replace(pushed, stabiliser="dcm-steps"), tell)
    assert caught.run.fell_at_s is None
    assert (caught.run.log.trimmed().foot_mode == FOOT_OFF).any(), "it has stepped"


def test_a_bush_on_a_robot_without_soles_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    corners = next(line for line in hrp2.file_texts()["hrp2.toml"].splitlines() if line.startswith("left_foot = ["))
    robot = variants.write_variant(tmp_path, file=[(corners, "")])
    arguments = ["replay", "groove", "--robot", str(robot), "--plant", "servo", "--feet-compliance", "2500,2500"]
    assert cli.main([*arguments, "--out", "out"]) == 2
    error = capsys.readouterr().err
    assert "soles.left_foot" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
