"""Dances on servos and compliant feet: one controller beside the other, and the feedback's gains one by one."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.kimoh2013.damping.stance import stance_of
from scenarios.replay import ProgressCallback, Replay, reference_motion
from sim.drivers import PositionController
from sim.loop import run
from sim.world import World
from sot.hardware.compliance import FootCompliance
from sot.hardware.hardware import Hardware
from sot.hardware.sensors import Sensors
from sot.hardware.servo import Servo
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.admittance import AdmittanceGains
from sot.servo.damping import DampingController, PlaneDesigns, single_support_share
from sot.servo.identified import Identified
from sot.servo.load_sharing import load_ramp
from sot.servo.soft_feet import refuse_soft_feet
from sot.servo.stabiliser import DcmGains, Stabiliser

Array = np.ndarray

DANCE, STEPS, GAINS = "dance", "steps", "gains"
STUDIES = {
    DANCE: "planted",
    STEPS: "auto",
    GAINS: "auto",
}
"""Studies of dances, and whether feet stay or step in them."""
CLIP = "groove"
GAIN_SHARES = 0.7, 1.3
"""Factors by which each gain is changed alone."""

Make = Callable[[], PositionController]


def dance_figures(
    request: Replay,
    study: str,
    compliance: FootCompliance,
    identified: Identified | None,
    ratio: float,
    tell: ProgressCallback,
) -> dict[str, Any]:
    """Let a robot dance on servos and compliant feet, once with each controller of a study.

    Args:
        request: names clip, part, robot and the rest; `groove` unless it names one.
        study: one of `STUDIES`.
        compliance: of the feet.
        identified: the robot's pendulums; None where it was not identified.
        ratio: damping ratio asked of the damping controller.
        tell: told of the progress.

    Raises:
        InputError: a clip that cannot be danced, feet too soft for it, or a design that is refused.
    """
    robot = Robot.load(request.robot)
    request = replace(request, clip=request.clip or CLIP, feet=STUDIES[study])
    period = 1.0 / request.rate
    planes = identified.designs(ratio, period)[0] if identified is not None and study != GAINS else None
    motion, _ = reference_motion(request, robot, tell)
    refuse_soft_feet(compliance, motion)
    if study == GAINS:
        return controller_figures(motion, compliance, gain_changes(motion, compliance, period), tell)
    damping = None if planes is None else partial(_damping, planes, motion)
    return controller_figures(motion, compliance, stabilisers(motion, compliance, period, damping), tell)


def _damping(planes: tuple[PlaneDesigns, PlaneDesigns], motion: Motion) -> DampingController:
    share = single_support_share(motion.phases, load_ramp(motion))
    return DampingController(planes, share, stance_of(motion.robot, "double").reach)


def stabilisers(
    motion: Motion, compliance: FootCompliance, period: float, damping: Callable[[], DampingController] | None
) -> dict[str, Make]:
    """Controllers of a dance by name: nothing, sag undone, each feedback alone, and with it.

    Args:
        motion: the plan.
        compliance: of the feet.
        period: control period [s].
        damping: makes the damping controller; None where the robot was not identified.
    """
    feedbacks: dict[str, dict[str, Callable[[], Any]]] = {"open": {}, "dcm": {"dcm": DcmGains}}
    if damping is not None:
        feedbacks["damping"] = {"damping": damping}

    def maker(parts: Mapping[str, Callable[[], Any]], known: FootCompliance | None) -> Make:
        servo = None if known is None else Servo.of(motion.robot)
        return lambda: Stabiliser(motion, period, known, servo, **{name: make() for name, make in parts.items()})

    made = {}
    for name, parts in feedbacks.items():
        made[name] = maker(parts, None)
        made["sag" if name == "open" else f"{name} + sag"] = maker(parts, compliance)
    return made


def gain_changes(motion: Motion, compliance: FootCompliance, period: float) -> dict[str, Make]:
    """The feedback of the divergent component with its gains as they are, and each alone less and more."""
    usual = DcmGains()
    changed = {"as they are": usual}
    for share in GAIN_SHARES:
        changed[f"convergence × {share:g}"] = replace(usual, convergence=share * usual.convergence)
        for name in AdmittanceGains.__dataclass_fields__:
            feet = replace(usual.feet, **{name: share * getattr(usual.feet, name)})
            changed[f"{name} × {share:g}"] = replace(usual, feet=feet)

    def maker(gains: DcmGains) -> Make:
        return lambda: Stabiliser(motion, period, compliance, Servo.of(motion.robot), dcm=gains)

    return {name: maker(gains) for name, gains in changed.items()}


def controller_figures(
    motion: Motion, compliance: FootCompliance, controllers: Mapping[str, Make], tell: ProgressCallback
) -> dict[str, dict[str, Any]]:
    """What became of a motion under each controller.

    Returns:
        Controller -> when it fell [s], root mean square of the zero-moment point off its plan [m], and the centre of
        mass off its plan at the end [m].
    """
    robot = motion.robot
    hardware = Hardware(Servo.of(robot), compliance, Sensors())
    found = {}
    for k, (name, make) in enumerate(controllers.items()):
        tell(name, k / len(controllers))
        done = run(make(), World(robot, 1.0 / motion.rate, hardware=hardware), motion)
        log = done.log.trimmed()
        off = log.zmp_measured - log.zmp_planned
        off = off[np.isfinite(off).all(axis=1)]
        end = log.com[-1, :2] - motion.sample(float(log.time[-1])).com[:2]
        found[name] = {
            "fell_at_s": done.fell_at_s,
            "zmp_rms_m": float(np.sqrt(np.mean(np.sum(off**2, axis=1)))),
            "com_off_at_end_m": float(np.linalg.norm(end)),
        }
    return found


def print_dances(controllers: Mapping[str, Mapping[str, Any]], console: Console) -> None:
    """Print a row a controller."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in ("controller", "how it ended", "ZMP off its plan\nmm", "CoM off at the end\nmm"):
        table.add_column(words, justify="right" if "mm" in words else "left")
    for name, found in controllers.items():
        fell = found["fell_at_s"]
        table.add_row(
            name,
            "upright" if fell is None else f"fell at {fell:.1f} s",
            f"{1e3 * found['zmp_rms_m']:.1f}",
            "-" if fell is not None else f"{1e3 * found['com_off_at_end_m']:.0f}",
        )
    console.print(table)
