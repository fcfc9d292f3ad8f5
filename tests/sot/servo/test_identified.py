"""Identified pendulums in their file, and the controllers made of them."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.servo.damping import DampingController
from sot.servo.identified import (
    PLANES,
    SUPPORTS,
    Identified,
    IdentifiedCase,
    identified_robots,
    read_identified,
    write_identified,
)
from sot.servo.pendulum import Pendulum
from sot.servo.pendulum_fit import FrequencyResponse, fit_errors

FREQUENCIES = np.geomspace(0.2, 10.0, 19)


def case(stiffness: float, delay: float = 0.005) -> IdentifiedCase:
    pendulum = Pendulum(58.0, 0.78, stiffness, 0.01 * stiffness, 8.0, 6.0, 0.002, delay)
    return IdentifiedCase(pendulum, FrequencyResponse(FREQUENCIES, pendulum.response(FREQUENCIES)))


def identified() -> Identified:
    stiff = {(plane, "double"): case(4900.0) for plane in ("xz", "yz")}
    return Identified("hrp2", (2500.0, 2500.0), stiff | {("xz", "single"): case(2450.0)})


def test_what_is_written_is_read(tmp_path):
    path, before = tmp_path / "pendulum.toml", identified()
    write_identified(path, before)
    after = read_identified(path)
    assert (after.robot, after.bush, set(after.cases)) == (before.robot, before.bush, set(before.cases))
    for key, one in before.cases.items():
        assert after.cases[key].pendulum.stiffness == pytest.approx(one.pendulum.stiffness, rel=1e-5)
        np.testing.assert_allclose(after.cases[key].measured.value, one.measured.value, rtol=1e-4)


@pytest.mark.parametrize(
    "before, after, words",
    [
        ('robot = "hrp2"', "", 'needs robot = "NAME"'),
        ("[xz.double]", "[zz.double]", "'zz' is no plane"),
        ("[xz.double]", "[xz.triple]", "'xz.triple' is no support"),
        ("mass = 58", "mass = -58", "not negative"),
        ("mass = 58", "weight = 58", "nothing else"),
        ("stiffness = 4900", "stiffness = 300", "more than m g l"),
        ("frequency = [0.2, ", "frequency = [", "of one length"),
        ("frequency = [0.2, ", "frequency = [9.0, ", "rising"),
    ],
)
def test_what_makes_no_pendulum_is_refused(tmp_path, before, after, words):
    path = tmp_path / "pendulum.toml"
    write_identified(path, identified())
    text = path.read_text()
    assert before in text
    path.write_text(text.replace(before, after, 1))
    with pytest.raises(InputError, match=words):
        read_identified(path)


def test_a_support_that_was_not_identified_falls_back_to_the_stiffer_one():
    (x, y), margins = identified().designs(0.72, 0.005)
    assert x.single is not x.double
    assert y.single is y.double
    assert set(margins) == {"xz-double", "yz-double", "xz-single"}
    assert min(margins.values()) > 0.5


def test_without_double_support_nothing_can_be_designed():
    only_single = Identified("hrp2", (), {("xz", "single"): case(2450.0)})
    with pytest.raises(InputError, match="double support was not identified in xz"):
        only_single.designs(0.72, 0.005)


def test_the_papers_form_is_refused_by_its_margin():
    with pytest.raises(InputError, match="paper form is refused"):
        identified().designs(0.72, 0.005, "paper")


def test_what_comes_with_the_project_fits_what_was_measured():
    for path in identified_robots().values():
        for one in read_identified(path).cases.values():
            errors = fit_errors(one.pendulum, one.measured)
            assert errors.gain_db < 0.5
            assert errors.phase_deg < 4.0
        planes, _ = read_identified(path).designs(0.72, 0.005)
        DampingController(planes, lambda t: 0.5, np.array([0.1, 0.1]))(0.0, np.zeros(2))


@pytest.mark.parametrize("robot", identified_robots())
def test_robots_that_come_identified_have_all_four_cases(robot):
    found = read_identified(identified_robots()[robot])
    assert set(found.cases) == {(plane, support) for plane in PLANES for support in SUPPORTS}
    assert len(found.designs(0.72, 0.005)[1]) == 4
