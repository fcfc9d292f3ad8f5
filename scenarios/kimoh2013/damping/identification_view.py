"""Kim & Oh's Figures 12 and 13 of our own robots: Bode plots with fits, and root loci."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.kimoh2013.damping.identification import PAPER_RATIO, CaseResult
from sim.reporting.chart import Curve, Panel, write_panels
from sot.servo.pendulum import NEGLIGIBLE_TIME, Pendulum

Array = np.ndarray
Results = Mapping[tuple[str, str], CaseResult]

MEASURED_COLOR, FIT_COLOR, NO_LOSS_COLOR, ASKED_COLOR = "#d9762b", "#2b6fd9", "#999", "#2a9d5c"
GAINS = np.concatenate([[0.0], np.geomspace(2e-3, 5.0, 200)])
"""Output feedback of the root locus, in 1 / l."""
SHOWN_RATIO = 3.5
"""Part of the complex plane that is drawn, in ω_n."""


def draw_bode(path: Path, label: str, results: Results) -> None:
    """Figure 12 of all cases: gain and phase, measured and fitted."""
    panels = []
    for (plane, support), result in results.items():
        pendulum, (frequency, value) = result.case.pendulum, result.case.measured
        fine = np.geomspace(frequency[0], frequency[-1], 400)
        fitted = pendulum.response(fine)
        log_fine, log_measured = np.log10(fine), np.log10(frequency)
        # The phase that is measured lies on the branch of the fit.
        phase = np.unwrap(np.angle(fitted))
        near = np.interp(log_measured, log_fine, phase)
        measured_phase = near + np.angle(value * np.exp(-1j * near))
        rows = (
            ("gain [dB of m/rad]", 20.0 * np.log10(np.abs(value)), 20.0 * np.log10(np.abs(fitted))),
            ("phase [deg]", np.rad2deg(measured_phase), np.rad2deg(phase)),
        )
        for words, points, line in rows:
            curves = [
                Curve(log_fine, line, FIT_COLOR, "fit"),
                _crosses(log_measured, points, 0.02 * np.ptp(log_fine), 0.02 * np.ptp(line), "measured"),
            ]
            panels.append(Panel(f"{plane}, {support} support", "log10 of the frequency [Hz]", words, curves))
    write_panels(path, f"{label}: zero-moment point over reference (Kim & Oh Figure 12)", panels, 2)


def draw_root_loci(path: Path, label: str, results: Results) -> None:
    """Figure 13 of all cases: where proportional feedback of the zero-moment point leads the poles."""
    panels = []
    for (plane, support), result in results.items():
        pendulum = result.case.pendulum
        numerator, denominator = _polynomials(pendulum)
        size = pendulum.natural_frequency * SHOWN_RATIO
        curves = []
        for sign, color, words in ((1.0, FIT_COLOR, "u = -k y"), (-1.0, NO_LOSS_COLOR, "u = +k y")):
            poles = [np.roots(np.polyadd(denominator, sign * k / pendulum.length * numerator)) for k in GAINS]
            x, y = _dots(np.concatenate(poles), size)
            curves.append(Curve(x, y, color, words, width=2.0))
        asked = pendulum.natural_frequency * (-PAPER_RATIO + 1j * np.sqrt(1.0 - PAPER_RATIO**2))
        wide = 0.03 * size
        for points, color, words in (
            (np.roots(denominator), "#333", "poles"),
            (np.roots(numerator), MEASURED_COLOR, "zeros"),
            (np.array([asked, asked.conjugate()]), ASKED_COLOR, f"asked, {PAPER_RATIO:g}"),
        ):
            shown = points[(np.abs(points.real) < size) & (np.abs(points.imag) < size)]
            curves.append(_crosses(shown.real, shown.imag, wide, wide, words, color))
        panels.append(Panel(f"{plane}, {support}", "real [1/s]", "imaginary [rad/s]", curves, equal=True))
    write_panels(path, f"{label}: root loci (Kim & Oh Figure 13)", panels, 2, (520.0, 360.0))


def print_identification(figures: Mapping[str, Mapping[str, Any]], console: Console) -> None:
    """Print a row a case."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in ("case", "f_n\nHz", "built in\nHz", "zeta\n", "built in\n", "K/mg\nm/rad", "lag, delay\nms"):
        table.add_column(words, justify="left" if words == "case" else "right")
    for words in ("fit\ndB", "\ndeg", "ZMP\nmm", "margin at 0.72\nfiltered, paper"):
        table.add_column(words, justify="right")
    for name, case in figures.items():
        low, high = case["zmp_amplitude_mm"]
        margins = ", ".join("-" if value is None else f"{value:.2f}" for value in case["margins"].values())
        table.add_row(
            name,
            f"{case['natural_frequency_hz']:.3f}",
            f"{case['natural_frequency_built_in_hz']:.3f}",
            f"{case['damping_ratio']:.4f}",
            f"{case['damping_ratio_built_in']:.4f}",
            f"{case['high_frequency_gain_m']:.2f}",
            f"{1e3 * case['lag_s']:.1f}, {1e3 * case['delay_s']:.1f}",
            f"{case['fit_db']:.2f}",
            f"{case['fit_deg']:.1f}",
            f"{low:.0f}-{high:.0f}",
            margins,
        )
    console.print(table)


def _polynomials(pendulum: Pendulum) -> tuple[Array, Array]:
    """Numerator and denominator of y / u, the delay by Padé."""
    inverted = np.array([pendulum.leading_inertia, 0.0, -pendulum.weight * pendulum.length])
    numerator: Array = -np.polymul([pendulum.damping, pendulum.stiffness], inverted) / pendulum.weight
    excess = pendulum.stiffness - pendulum.weight * pendulum.length
    denominator: Array = np.array([pendulum.turning_inertia, pendulum.damping, excess])
    zeros, poles = pendulum.bending_polynomials
    numerator, denominator = np.polymul(numerator, zeros), np.polymul(denominator, poles)
    if pendulum.lag > NEGLIGIBLE_TIME:
        denominator = np.polymul(denominator, [pendulum.lag, 1.0])
    if pendulum.delay > NEGLIGIBLE_TIME:
        numerator = np.polymul(numerator, [-0.5 * pendulum.delay, 1.0])
        denominator = np.polymul(denominator, [0.5 * pendulum.delay, 1.0])
    return numerator, denominator


def _crosses(x: Array, y: Array, wide: float, high: float, label: str, color: str = MEASURED_COLOR) -> Curve:
    """Points as small crosses."""
    gap = np.full(len(x), np.nan)
    across: Array = np.column_stack([x - wide, x + wide, gap, x, x, gap]).ravel()
    along: Array = np.column_stack([y, y, gap, y - high, y + high, gap]).ravel()
    return Curve(across, along, color, label)


def _dots(points: Array, size: float) -> tuple[Array, Array]:
    """Points of a square as the shortest lines that show."""
    shown = points[(np.abs(points.real) < size) & (np.abs(points.imag) < size)]
    gap, short = np.full(len(shown), np.nan), 0.004 * size
    x: Array = np.column_stack([shown.real - short, shown.real + short, gap]).ravel()
    return x, np.column_stack([shown.imag, shown.imag, gap]).ravel()
