"""Boxes again and again: how heavy one may be, how far off its place, and how wrong its mass may be told.

`python -m scenarios.otani2017.trials heaviest` lifts heavier and heavier boxes, and says what stops it.
`python -m scenarios.otani2017.trials noise` handles a box that stands beside its place, of another mass than is told.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import typer

from scenarios.otani2017.figures import object_report
from scenarios.otani2017.otani import Handling, perform
from scenarios.otani2017.scene import ObjectOptions
from scenarios.replay import Replay
from scenarios.terminal import run_app
from sim.reporting.figures import SATURATION_RATIO
from sot.errors import InputError

MAX_END_ERROR_M, MAX_END_TILT_DEG = 0.03, 5.0
"""How far a box that was handled may be off its place, and tilt, at the end."""
MAX_NAMED_JOINTS = 3

app = typer.Typer(add_completion=False, no_args_is_help=True)
RobotName = Annotated[str, typer.Option("--robot", help="A name of `sot list robots`, or a robot file (.toml).")]
Rate = Annotated[float, typer.Option(help="Control ticks per second [Hz].")]
FromPlate = Annotated[bool, typer.Option("--from-plate", help="From a low plate, not from a stand.")]


@dataclass(frozen=True)
class Trial:
    """How a box was handled.

    Attributes:
        mass: Of the box [kg].
        failure: Why it was not handled, or not as it should be; empty if it was.
        slip, end_error: Greatest slip in the hands, and distance of the box from its place at the end [m].
        lifted: Greatest height over where it stood [m].
        saturated: Share of the ticks with a torque at its limit.
        joint_loads: Joint -> its greatest torque over its effort, the greatest first.
    """

    mass: float
    failure: str
    slip: float
    end_error: float
    lifted: float
    saturated: float
    joint_loads: tuple[tuple[str, float], ...]

    def __str__(self) -> str:
        loads = ", ".join(f"{joint} {100.0 * load:.0f} %" for joint, load in self.joint_loads[:MAX_NAMED_JOINTS])
        return (
            f"{self.mass:5.1f} kg: {self.failure or 'handled'}; lifted by {self.lifted:.2f} m, slip"
            f" {1e3 * self.slip:.1f} mm, off its place by {1e3 * self.end_error:.1f} mm; saturated in"
            f" {100.0 * self.saturated:.1f} % of the ticks, torques up to {loads}"
        )


def trial(request: Replay, handling: Handling) -> Trial:
    """Handle a box once; nothing is written."""
    danced, schedule, system = perform(request, handling, lambda what, share: None)
    log = danced.run.log.trimmed()
    box = object_report(log, system, schedule.demonstration)["box"]
    failures = [schedule.failure] if schedule.failure else []
    if danced.run.fell_at_s is not None:
        failures.append(f"the robot fell at {danced.run.fell_at_s:.1f} s, {danced.run.reason}")
    elif not failures and (box["end_error_m"] > MAX_END_ERROR_M or box["end_tilt_deg"] > MAX_END_TILT_DEG):
        failures.append("the box does not stand where it should")
    loads = np.abs(log.torque).max(axis=0) / system.robot.effort
    return Trial(
        mass=box["mass_kg"],
        failure=" and ".join(failures),
        slip=box["slip_max_m"],
        end_error=box["end_error_m"],
        lifted=box["lifted_max_m"],
        saturated=float((np.abs(log.torque) >= SATURATION_RATIO * system.robot.effort).any(axis=1).mean()),
        joint_loads=tuple((system.robot.joints[k], float(loads[k])) for k in np.argsort(-loads)),
    )


def heavier_boxes(request: Replay, first: float, step: float, from_plate: bool = False) -> Iterator[Trial]:
    """Trials with boxes that are heavier by a step each time [kg], to the first that is not handled."""
    mass = first
    while True:
        done = trial(request, Handling("box", from_plate, ObjectOptions(mass)))
        yield done
        if done.failure:
            return
        mass += step


@app.command()
def heaviest(
    robot: RobotName = "hrp2",
    rate: Rate = 1000.0,
    first: Annotated[float, typer.Option(help="Mass of the first box [kg].")] = 2.0,
    step: Annotated[float, typer.Option(help="By which the next one is heavier [kg].")] = 2.0,
    from_plate: FromPlate = False,
) -> None:
    """Lift heavier and heavier boxes, a line each, until one is not handled."""
    if not (first > 0.0 and step > 0.0):
        raise InputError("--first and --step must be above 0 kg")
    for done in heavier_boxes(Replay("otani", robot, rate=rate), first, step, from_plate):
        print(done, flush=True)


@app.command()
def noise(
    robot: RobotName = "hrp2",
    rate: Rate = 1000.0,
    mass: Annotated[float, typer.Option(help="Mass of the box [kg].")] = 3.0,
    told: Annotated[
        float | None, typer.Option(help="Mass that the controller is told [kg]; the box's unless given.")
    ] = None,
    seeds: Annotated[int, typer.Option(help="Number of places, 3 mm and 2 degrees off by standard deviation.")] = 5,
    from_plate: FromPlate = False,
) -> None:
    """Handle a box that stands beside its place, a line for each seed."""
    believed = None if told is None else ObjectOptions(told)
    request, handled = Replay("otani", robot, rate=rate), 0
    for seed in range(1, seeds + 1):
        done = trial(request, Handling("box", from_plate, ObjectOptions(mass), believed, seed=seed))
        handled += not done.failure
        print(f"seed {seed}: {done}", flush=True)
    print(f"{handled} of {seeds} handled")


def main() -> int:
    """Run the command line; returns the exit code."""
    return run_app(app)


if __name__ == "__main__":
    sys.exit(main())
