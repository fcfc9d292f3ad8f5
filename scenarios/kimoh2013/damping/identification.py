"""Identification of a robot on compliant feet, Kim & Oh 4.2: sweeps, fits, and the model of what was built in."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenarios.kimoh2013.damping.stance import Stance, stance_of
from scenarios.kimoh2013.damping.sweep import SAMPLING_RATE, SwayingRobot, Sweep, sweep
from sot.errors import InputError
from sot.hardware.compliance import FootCompliance
from sot.hardware.servo import Servo
from sot.robots.robot import Robot
from sot.servo.identified import PLANES, Identified, IdentifiedCase
from sot.servo.pendulum_fit import fit_errors, fit_pendulum
from sot.servo.pole_placement import FORMS, design_damping
from sot.servo.soft_feet import refuse_soft_feet
from sot.servo.sway_modes import SwayMode, sway_modes

PAPER_RATIO = 0.72
"""Damping ratio that Kim & Oh ask for."""


@dataclass(frozen=True)
class CaseResult:
    """What one case gave.

    Attributes:
        sweep: what was measured.
        case: what was fitted.
        built_in: the sway by the linear model of the whole robot.
    """

    sweep: Sweep
    case: IdentifiedCase
    built_in: SwayMode


def identify(
    robot: Robot,
    compliance: FootCompliance,
    cases: Sequence[tuple[str, str]],
    tell: Callable[[str, float | None], object],
) -> dict[tuple[str, str], CaseResult]:
    """Sweep and fit cases (plane, support).

    Raises:
        InputError: bushes that are too soft, or a robot that falls over.
    """
    stances = {support: stance_of(robot, support) for support in {one for _, one in cases}}
    for stance in stances.values():
        refuse_soft_feet(compliance, stance.motion(1.0, 10.0))
    results = {}
    for k, (plane, support) in enumerate(cases):
        stance = stances[support]
        modes = built_in_modes(stance, compliance)

        def told(share: float, k: int = k, name: str = f"{plane}, {support} support") -> None:
            tell(f"sweeping {name}", (k + share) / len(cases))

        told(0.0)
        found = sweep(stance, compliance, plane, told)
        pendulum = fit_pendulum(found.response, robot.mass, stance.length)
        results[plane, support] = CaseResult(
            found, IdentifiedCase(pendulum, found.response), modes[PLANES.index(plane)]
        )
    return results


def built_in_modes(stance: Stance, compliance: FootCompliance) -> tuple[SwayMode, SwayMode]:
    """The sway by the linear model of the whole robot, on the floor that is under it."""
    standing = SwayingRobot(stance, compliance, PLANES[0])
    standing.rest()
    robot = stance.robot
    return sway_modes(robot, stance.q, list(stance.feet), Servo.of(robot), compliance, standing.floor_contacts())


def identified_of(robot: Robot, compliance: FootCompliance, results: dict[tuple[str, str], CaseResult]) -> Identified:
    """What goes into the robot's file."""
    bush = (compliance.roll, compliance.pitch, compliance.vertical)
    known = bush if np.isfinite(bush).all() else bush[:2]
    return Identified(robot.name, known, {key: result.case for key, result in results.items()})


def case_figures(result: CaseResult) -> dict[str, Any]:
    """The figures of a case for the report."""
    pendulum, measured = result.case.pendulum, result.case.measured
    errors = fit_errors(pendulum, measured)
    frequency = pendulum.natural_frequency / (2.0 * np.pi)
    return {
        "natural_frequency_hz": frequency,
        "natural_frequency_built_in_hz": result.built_in.frequency,
        "natural_frequency_error": frequency / result.built_in.frequency - 1.0,
        "damping_ratio": pendulum.damping_ratio,
        "damping_ratio_built_in": result.built_in.damping_ratio,
        "damping_ratio_error": pendulum.damping_ratio / result.built_in.damping_ratio - 1.0,
        "static_gain_m": pendulum.static_gain,
        "high_frequency_gain_m": pendulum.high_frequency_gain,
        "stiffness": pendulum.stiffness,
        "damping": pendulum.damping,
        "inertia": pendulum.inertia,
        "led_inertia": pendulum.led_inertia,
        "lag_s": pendulum.lag,
        "delay_s": pendulum.delay,
        "fit_db": errors.gain_db,
        "fit_deg": errors.phase_deg,
        "zmp_amplitude_mm": [1e3 * float(part(result.sweep.zmp_amplitude)) for part in (np.min, np.max)],
        "margins": {form: _margin(result.case, form) for form in FORMS},
    }


def _margin(case: IdentifiedCase, form: str) -> float | None:
    try:
        design = design_damping(case.pendulum, PAPER_RATIO, 1.0 / SAMPLING_RATE, form)
    except InputError:
        return None
    return design.margin(case.measured)
