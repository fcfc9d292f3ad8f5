"""Poles where they are asked for, margins on responses, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import cont2discrete, tf2ss

from sot.errors import InputError
from sot.servo.pendulum import Pendulum
from sot.servo.pendulum_fit import FrequencyResponse
from sot.servo.pole_placement import FORMS, DampingDesign, checked_margin, design_damping

PENDULUM = Pendulum(58.0, 0.78, 4900.0, 50.0, 8.0, 6.0, 0.002, 0.01)
FREQUENCIES = np.geomspace(0.2, 10.0, 19)
PERIOD = 0.005


def response(pendulum: Pendulum) -> FrequencyResponse:
    return FrequencyResponse(FREQUENCIES, pendulum.response(FREQUENCIES))


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("ratio", [0.3, 0.5, 0.72])
def test_the_pendulums_poles_are_moved_and_no_others(form, ratio):
    design = design_damping(PENDULUM, ratio, PERIOD, form)
    A, B, _, _ = design.system
    before, after = (np.log(np.linalg.eigvals(M).astype(complex)) / PERIOD for M in (A, A - B @ design.feedback))
    moved = [pole for pole in after if np.min(np.abs(before - pole)) > 1e-3]
    assert len(moved) == 2
    for pole in moved:
        assert -pole.real / abs(pole) == pytest.approx(ratio, rel=1e-6)


def test_paper_gain_is_that_of_its_equations():
    """u = −k θ̇ with k = 2 (ζ_des − ζ) ω_n m l² / K, for ω_des = ω_n; here from sample to sample."""
    pendulum = Pendulum(58.0, 0.78, 4900.0, 50.0)
    design = design_damping(pendulum, 0.5, 1e-4, "paper")
    gain = 2.0 * (0.5 - pendulum.damping_ratio) * pendulum.natural_frequency * 58.0 * 0.78**2 / 4900.0
    assert design.feedback[0, 1] == pytest.approx(gain, rel=1e-2)
    assert abs(design.feedback[0, 0]) < 1e-2


@pytest.mark.parametrize("form", FORMS)
def test_the_loop_oscillates_as_its_margin_says(form):
    """The margin's sign against the eigenvalues of pendulum and controller together, from sample to sample."""
    outcomes, fine = set(), np.geomspace(0.02, 95.0, 400)
    design = design_damping(PENDULUM, 0.72, PERIOD, form)
    for delay in (0.0, 0.01, 0.02, 0.04, 0.08, 0.12, 0.2):
        plant = replace(PENDULUM, lag=0.004, delay=delay)
        # Half a period of the hold, and the one that passes until it is seen.
        seen = replace(plant, delay=delay + PERIOD).response(fine) * np.exp(-1j * np.pi * fine * PERIOD)
        margin = design.margin(FrequencyResponse(fine, seen * np.sinc(fine * PERIOD)))
        outcomes.add(margin > 0.0)
        assert (margin > 0.0) == _is_stable(design, plant), delay
    # The paper's controller is unstable by itself, and a pole of the robot that it does not know of is too much for it.
    assert outcomes == ({True, False} if form == "filtered" else {False})


def _is_stable(design: DampingDesign, plant: Pendulum) -> bool:
    """Whether all eigenvalues of plant and controller together are inside the unit circle; delays are whole samples."""
    p = plant
    numerator = -np.polymul([p.damping, p.stiffness], [p.leading_inertia, 0.0, -p.weight * p.length]) / p.weight
    excess = p.stiffness - p.weight * p.length
    denominator = np.polymul([p.turning_inertia, p.damping, excess], [p.lag, 1.0])
    held = cont2discrete(tf2ss(numerator, denominator), PERIOD)
    # What is commanded from a tick on is seen at the next one, after that many more.
    late, n = round(p.delay / PERIOD) + 1, len(held[0])
    line = np.eye(late, k=-1)
    A = np.block([[held[0], held[1] @ np.eye(1, late, late - 1)], [np.zeros((late, n)), line]])
    B, C = np.eye(n + late, 1, -n), np.hstack([held[2], held[3] @ np.eye(1, late, late - 1)])
    Ac, Bc, Cc, Dc = design.controller
    loop = np.block([[A + B @ Dc @ C, B @ Cc], [Bc @ C, Ac]])
    return bool(np.abs(np.linalg.eigvals(loop)).max() < 1.0)


def test_a_delay_that_nobody_knew_of_is_refused():
    late = Pendulum(58.0, 0.78, 4900.0, 50.0, 8.0, 6.0, 0.002, 0.08)
    design = design_damping(PENDULUM, 0.72, PERIOD)
    assert checked_margin(design, response(PENDULUM), "xz-double") > 0.5
    with pytest.raises(InputError, match=r"xz-double: damping ratio 0.72 in the filtered form is refused"):
        checked_margin(design, response(late), "xz-double")


@pytest.mark.parametrize("ratio, form, words", [(0.0, "filtered", "more than 0"), (0.5, "other", "unknown form")])
def test_what_makes_no_design_is_refused(ratio, form, words):
    with pytest.raises(InputError, match=words):
        design_damping(PENDULUM, ratio, PERIOD, form)


def test_a_joint_too_soft_to_stand_on_is_refused():
    with pytest.raises(InputError, match="too soft"):
        design_damping(Pendulum(58.0, 0.78, 400.0, 4.0), 0.5, PERIOD)
