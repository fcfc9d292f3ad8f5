"""`sot run damping`: a position-controlled robot on compliant feet, identified and pushed, Kim & Oh 4 and 5.2."""

from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from scenarios.kimoh2013.damping import dances
from scenarios.kimoh2013.damping.identification import PAPER_RATIO, case_figures, identified_of, identify
from scenarios.kimoh2013.damping.identification_view import draw_bode, draw_root_loci, print_identification
from scenarios.kimoh2013.damping.largest_pushes import largest_push_figures, print_largest_pushes
from scenarios.kimoh2013.damping.push_view import draw_sways, print_pushes
from scenarios.kimoh2013.damping.pushes import RATIOS, controllers_of, push_figures
from scenarios.kimoh2013.damping.stance import usual_compliance
from scenarios.kimoh2013.damping.sweep import SAMPLING_RATE
from scenarios.replay import REPORT_FILE, ProgressCallback, Replay, check_writable
from sim.reporting import report
from sot.errors import InputError
from sot.hardware.compliance import FootCompliance
from sot.robots.robot import Robot
from sot.servo.identified import PLANES, SUPPORTS, Identified, identified_robots, read_identified, write_identified
from sot.servo.sag import bush_compliance

STUDIES = ("identify", "push", *dances.STUDIES)
CASES = tuple((plane, support) for support in SUPPORTS for plane in PLANES)
BUSH_TOLERANCE = 0.1
"""Difference of their compliances, as a share, up to which feet count as those that a robot was identified on."""
PENDULUM_FILE, BODE_FILE, LOCUS_FILE, SWAY_FILE = "pendulum.toml", "bode.svg", "root_locus.svg", "pushes.svg"


@dataclass(frozen=True)
class DampingOptions:
    """What is asked for.

    Attributes:
        study: one of `STUDIES`.
        cases: of `CASES`.
        damping_ratio: asked of the controller; 0.3, 0.5 and the paper's 0.72 in turn unless given.
        form: one of `sot.servo.pole_placement.FORMS`.
        identified: file of the robot's pendulums; the one that comes with the project unless given.
        seeds: how many pushes of each kind.
    """

    study: str
    cases: tuple[tuple[str, str], ...] = CASES
    damping_ratio: float | None = None
    form: str = "filtered"
    identified: Path | None = None
    seeds: int = 5

    @property
    def takes_clip(self) -> bool:
        """Whether the study is of a clip, or of a robot that stands."""
        return self.study in dances.STUDIES


DEFAULT_OPTIONS = DampingOptions(STUDIES[0])


def run(request: Replay, options: DampingOptions, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Identify a robot, or push one that was identified; files appear in the folder `out`.

    Feet are as soft as suits the robot's weight, or as they were when it was identified, unless the request says.

    Raises:
        InputError: anything that does not fit; nothing is written then.
    """
    if options.takes_clip:
        return _dance(request, options, out, tell)
    if request != Replay("", request.robot, solver=request.solver, feet=request.feet, compliance=request.compliance):
        raise InputError("damping is a study: besides its own options it takes --robot, --feet-compliance and --out")
    check_writable(out)
    robot = Robot.load(request.robot)
    study = _identify if options.study == "identify" else _push
    figures = study(robot, request.compliance, options, out, tell)
    head = {"scenario": f"damping {options.study}", "robot": robot.name, "rate_hz": SAMPLING_RATE}
    report.write_json(head | figures, out / REPORT_FILE)
    return head | figures


def _dance(request: Replay, options: DampingOptions, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    check_writable(out)
    robot, identified = Robot.load(request.robot), None
    if options.study != dances.GAINS and (options.identified is not None or robot.name in identified_robots()):
        identified = _identified(robot, options.identified)
        compliance = _feet(robot, identified, request.compliance)
    else:
        compliance = request.compliance or usual_compliance(robot)
    told = options.study, compliance, identified, options.damping_ratio or PAPER_RATIO, tell
    figures = {"controllers": dances.dance_figures(request, *told)}
    head = {"scenario": f"damping {options.study}", "robot": robot.name, "clip": request.clip or dances.CLIP}
    out.mkdir(parents=True, exist_ok=True)
    report.write_json(head | figures, out / REPORT_FILE)
    return head | figures


def _identify(
    robot: Robot, soft: FootCompliance | None, options: DampingOptions, out: Path, tell: ProgressCallback
) -> dict[str, Any]:
    compliance = soft or usual_compliance(robot)
    results = identify(robot, compliance, options.cases, tell)
    out.mkdir(parents=True, exist_ok=True)
    write_identified(out / PENDULUM_FILE, identified_of(robot, compliance, results))
    draw_bode(out / BODE_FILE, robot.label, results)
    draw_root_loci(out / LOCUS_FILE, robot.label, results)
    return {"cases": {f"{plane}-{support}": case_figures(result) for (plane, support), result in results.items()}}


def _push(
    robot: Robot, soft: FootCompliance | None, options: DampingOptions, out: Path, tell: ProgressCallback
) -> dict[str, Any]:
    identified = _identified(robot, options.identified)
    compliance = _feet(robot, identified, soft)
    ratios = RATIOS if options.damping_ratio is None else (options.damping_ratio,)
    controllers = controllers_of(identified, ratios, options.form)
    frequencies = {}
    for plane, support in options.cases:
        if (plane, support) not in identified.cases:
            if options.cases == CASES:  # nobody named it
                continue
            raise InputError(f"{robot.label}: {plane}-{support} was not identified")
        frequencies[plane, support] = identified.cases[plane, support].pendulum.natural_frequency / (2.0 * pi)
    figures, sways = push_figures(robot, compliance, controllers, frequencies, options.seeds, tell)
    axes = frozenset(PLANES.index(plane) for plane, support in frequencies if support == "double")
    largest = largest_push_figures(robot, compliance, axes, options.seeds, tell)
    out.mkdir(parents=True, exist_ok=True)
    draw_sways(out / SWAY_FILE, robot.label, sways)
    return {"cases": figures, "largest_impulse_n_s": largest}


def _identified(robot: Robot, path: Path | None) -> Identified:
    if path is None:
        known = identified_robots()
        if robot.name not in known:
            raise InputError(
                f"{robot.label} was not identified: run `sot run damping identify --robot ...` and give its "
                f"{PENDULUM_FILE} with --identified"
            )
        path = known[robot.name]
    identified = read_identified(path)
    if identified.robot != robot.name:
        raise InputError(f"{path}: of the robot '{identified.robot}', not of '{robot.name}'")
    return identified


def _feet(robot: Robot, identified: Identified, asked: FootCompliance | None) -> FootCompliance:
    """The feet that were asked for, or those that the robot was identified on."""
    if not identified.bush:
        return asked or usual_compliance(robot)
    known = FootCompliance(*identified.bush)
    if asked is not None and not np.allclose(bush_compliance(asked), bush_compliance(known), BUSH_TOLERANCE, 0.0):
        told = ",".join(f"{value:g}" for value in identified.bush)
        raise InputError(
            f"--feet-compliance: {robot.label} was identified on feet of {told}, and its pendulums are not those of "
            f"others: identify it on these, and give its {PENDULUM_FILE} with --identified"
        )
    return asked or known


def show(figures: dict[str, Any], console: Console) -> None:
    """Print the table of the study."""
    if "controllers" in figures:
        dances.print_dances(figures["controllers"], console)
    else:
        (print_identification if figures["scenario"].endswith("identify") else print_pushes)(figures["cases"], console)
    if figures.get("largest_impulse_n_s"):
        print_largest_pushes(figures["largest_impulse_n_s"], console)
