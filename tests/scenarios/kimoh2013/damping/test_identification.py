"""Stances, sweeps and their pictures; a short sweep under physics against the linear model of what is built in."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios import cli
from scenarios.kimoh2013.damping import sweep as sweeps
from scenarios.kimoh2013.damping.identification import CaseResult, case_figures, identify
from scenarios.kimoh2013.damping.identification_view import draw_bode, draw_root_loci
from scenarios.kimoh2013.damping.stance import stance_of, usual_compliance
from scenarios.kimoh2013.damping.sweep import Sweep
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.servo.identified import IdentifiedCase, read_identified
from sot.servo.pendulum import Pendulum
from sot.servo.pendulum_fit import FrequencyResponse, fit_pendulum
from sot.servo.sway_modes import SwayMode


@pytest.mark.parametrize("support", ["double", "single"])
def test_a_stance_has_its_weight_over_its_bushes_and_knows_its_edges(support):
    robot = Robot.load("hrp2")
    stance = stance_of(robot, support)
    data = robot.model.createData()
    com = pin.centerOfMass(robot.model, data, stance.q).copy()
    np.testing.assert_allclose(com[:2], stance.pivot[:2], atol=1e-4)
    assert com[2] - stance.pivot[2] == pytest.approx(stance.length)
    corners = np.vstack([at.act(corner) for foot, at in stance.feet.items() for corner in robot.sole(foot)])
    sides = [np.abs(corners[:, axis] - stance.pivot[axis]) for axis in range(2)]
    np.testing.assert_allclose(stance.reach, [side.min() for side in sides], atol=1e-6) if support == "single" else None
    assert stance.reach[0] == pytest.approx(0.1, abs=1e-6)
    motion = stance.motion(0.5, 200.0)
    assert set(motion.phases[0].feet) == set(stance.feet)
    np.testing.assert_array_equal(motion.q[-1], stance.q)


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["damping"], "say which study"),
        (["damping", "identify", "--seeds", "3"], "damping identify takes no --seeds"),
        (["damping", "push", "--case", "xz-both"], "choose of xz-double"),
        (["damping", "push", "--form", "other"], "choose one of filtered, paper"),
        (["damping", "push", "--damping-ratio", "1.5"], "more than 0, and 1 at most"),
        (["damping", "push", "--form", "paper"], "paper form is refused, the loop is unstable"),
        (["damping", "push", "--robot", "g1", "--identified", "hrp2.toml"], "cannot be read"),
        (["sliding", "--case", "xz-double"], "sliding takes no --case"),
        (["damping", "identify", "--feet-compliance", "300,300"], "more than m g l"),
        (["damping", "identify", "--push", "t=1 force=1,0,0"], "takes --robot, --feet-compliance and --out"),
    ],
)
def test_what_makes_no_sense_is_one_line_and_leaves_nothing(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["run", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not list(tmp_path.rglob("*.*"))


def test_pictures_and_figures_of_a_case(tmp_path):
    pendulum = Pendulum(58.0, 0.78, 3500.0, 36.0, 1.0, 6.0, 0.004, 0.003)
    frequency = np.geomspace(0.2, 10.0, 19)
    response = FrequencyResponse(frequency, 1.02 * pendulum.response(frequency))
    found = Sweep("xz", response, *(np.full(19, value) for value in (0.001, 0.02, 0.01)))
    result = CaseResult(found, IdentifiedCase(pendulum, response), SwayMode(1.5, 0.05))
    for draw, name in ((draw_bode, "bode.svg"), (draw_root_loci, "root_locus.svg")):
        draw(tmp_path / name, "robot", {("xz", "double"): result})
        assert "nan" not in (tmp_path / name).read_text()
    figures = case_figures(result)
    assert figures["fit_db"] == pytest.approx(20.0 * np.log10(1.02), abs=1e-6)
    assert figures["margins"]["filtered"] > 0.4
    assert figures["natural_frequency_error"] == pytest.approx(figures["natural_frequency_hz"] / 1.5 - 1.0)


class MeasuredPendulum:
    """Stands in for a robot: sines answer with a pendulum's response, with errors."""

    def __init__(self, pendulum, error):
        self.pendulum, self.error, self.random = pendulum, error, np.random.default_rng(5)
        self.stance = stance_of(Robot.load("hrp2"), "single")

    def rest(self):
        pass

    def sine(self, robot, plane, frequency, gain, pole=None):
        value = self.pendulum.response(np.array([frequency]))[0] / self.stance.length
        self.gains = np.append(getattr(self, "gains", []), gain / abs(value))
        return sweeps._MeasuredSine(0.001, value * np.exp(self.error * self.random.standard_normal()), 0.0, True)


@pytest.mark.parametrize("frequency, ratio", [(0.793, 0.035), (0.99, 0.02), (1.47, 0.06)])
def test_a_sweep_measures_the_resonance_that_it_finds(frequency, ratio, monkeypatch):
    stance = stance_of(Robot.load("hrp2"), "single")
    mass, length = stance.robot.mass, stance.length
    inertia = 1.2 * mass * length**2
    omega = 2.0 * np.pi * frequency
    stiffness = inertia * omega**2 + mass * GRAVITY * length
    built_in = Pendulum(
        *(mass, length, stiffness, 2.0 * ratio * omega * inertia, 0.2 * mass * length**2, 6.0),
        *(0.0, 0.009, 0.3, 70.0, 0.4),
    )
    robot = MeasuredPendulum(built_in, 0.02)
    monkeypatch.setattr(sweeps, "SwayingRobot", lambda *told: robot)
    monkeypatch.setattr(sweeps, "_suitable_sine", robot.sine)
    coarse = tuple(np.geomspace(0.2, 10.0, 9).tolist())
    monkeypatch.setattr(sweeps, "FREQUENCIES", coarse)
    found = sweeps.sweep(stance, usual_compliance(stance.robot), "xz")
    assert np.all(np.diff(found.response.frequency) > 0.0)
    assert len(found.response.frequency) == len(found.amplitude) > len(coarse)
    offsets = (found.response.frequency / frequency - 1.0) / ratio
    assert np.any((offsets <= 0.0) & (offsets > -1.5)) and np.any((offsets >= 0.0) & (offsets < 1.5))
    pendulum = fit_pendulum(found.response, mass, length)
    assert pendulum.natural_frequency == pytest.approx(omega, rel=0.01)
    assert pendulum.damping_ratio == pytest.approx(ratio, rel=0.1)
    assert not sweeps.missing_frequencies(pendulum, found.response.frequency)


@pytest.mark.slow
def test_a_short_sweep_finds_what_is_built_in(monkeypatch, tmp_path):
    monkeypatch.setattr(sweeps, "FREQUENCIES", tuple(np.geomspace(0.6, 8.0, 9).tolist()))
    robot = Robot.load("hrp2")
    results = identify(robot, usual_compliance(robot), [("xz", "double")], lambda words, share: None)
    figures = case_figures(results["xz", "double"])
    assert abs(figures["natural_frequency_error"]) < 0.05
    assert abs(figures["damping_ratio_error"]) < 0.2
    assert figures["fit_db"] < 1.5
    assert figures["fit_deg"] < 8.0
    assert figures["margins"]["filtered"] > 0.5
    assert figures["margins"]["paper"] == -1.0


@pytest.mark.slow
def test_the_command_writes_a_file_that_can_be_read(monkeypatch, tmp_path):
    monkeypatch.setattr(sweeps, "FREQUENCIES", tuple(np.geomspace(1.0, 8.0, 7).tolist()))
    assert cli.main(["run", "damping", "identify", "--case", "yz-double", "--out", str(tmp_path)]) == 0
    identified = read_identified(tmp_path / "pendulum.toml")
    assert list(identified.cases) == [("yz", "double")]
    assert {path.name for path in tmp_path.iterdir()} == {
        *("pendulum.toml", "bode.svg", "root_locus.svg", "report.json")
    }
