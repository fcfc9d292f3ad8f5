"""`sot run otani carry`: a box taken from a stand, carried on the robot's own steps, and set down on another one."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from scenarios.inputs.stack_file import Composition
from scenarios.otani2017.carrying.scene import BOX, BOX_M, carry_demonstration, carry_things
from scenarios.otani2017.carrying.stack import carry_stack
from scenarios.otani2017.figures import manipulation_figures, object_report, tick_medians
from scenarios.otani2017.handling_stack import contacts_of
from scenarios.otani2017.scene import ObjectOptions, random_offset
from scenarios.replay import Dance, ProgressCallback, Replay, check_writable, make_solver, run_motion, write_outputs
from sim.log import RunLog
from sim.recording.things import HandledThings
from sim.reporting import report
from sot.behaviours.manipulation.walking import WalkingManipulation
from sot.motion.carry import carry
from sot.motion.feet.footwork import Foothold
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.system import System

BACK_M, AHEAD_M = 0.4, 1.6
"""Way of the body back from the first stand, and ahead to the second one after a quarter of a turn to the left [m]."""
NOISE_M, NOISE_DEG = 0.003, 2.0


@dataclass(frozen=True)
class Carrying:
    """A box that is carried.

    Attributes:
        actual: What the box is like in physics.
        believed: What the controller takes it to be like; as it is unless given.
        seed: Of the noise of its place; none without.
    """

    actual: ObjectOptions = field(default_factory=lambda: ObjectOptions(mass=2.0))
    believed: ObjectOptions | None = None
    seed: int | None = None

    takes_clip: ClassVar[bool] = False


def run(request: Replay, carrying: Carrying, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Plan, carry, record and report.

    Args:
        request: Robot, solver and rate.
        carrying: What is carried.
        out: Folder to write to.
        tell: Told of the progress.

    Raises:
        InputError: Anything in the request that does not fit; nothing is written then.
    """
    check_writable(out)
    make_solver(request.solver)
    danced, schedule, system = perform(request, carrying, tell)
    return write_outputs(danced, out, tell, report.rounded(carry_figures(danced.run.log.trimmed(), schedule, system)))


def perform(request: Replay, carrying: Carrying, tell: ProgressCallback) -> tuple[Dance, WalkingManipulation, System]:
    """Plan the carrying of a box and run it; nothing is written.

    Args:
        request: Robot, solver and rate.
        carrying: What is carried.
        tell: Told of the progress.

    Returns:
        The run, its schedule, and the robot with the things as they are simulated.
    """
    robot, believed = Robot.load(request.robot), carrying.believed or carrying.actual
    offset = (
        None
        if carrying.seed is None
        else random_offset(np.random.default_rng(carrying.seed), NOISE_M, np.radians(NOISE_DEG))
    )
    tell("planning", None)
    left = 0.5 * np.pi
    stops = [Foothold(-BACK_M, 0.0, 0.0), Foothold(-BACK_M, 0.0, left), Foothold(-BACK_M, AHEAD_M, left)]
    plan = carry(robot, BOX_M[1], believed.mass, stops, request.rate)
    system = System(robot, carry_things(plan, believed))
    demonstration = carry_demonstration(plan, system)
    contacts = contacts_of(demonstration)
    schedule = WalkingManipulation(demonstration, contacts)

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(carry_stack(demonstration, contacts, schedule), schedule)

    things = carry_things(plan, carrying.actual, offset)
    danced = run_motion(
        replace(request, clip="carry"), compose, demonstration.motion, None, tell, system=system, things=things
    )
    played = schedule.played()
    danced.run.log.zmp_planned[: len(played.zmp)] = played.zmp  # the run knew the motion only as it is without waits
    assert danced.system is not None
    handled = HandledThings(schedule.history, schedule.played_times())
    return replace(danced, motion=played, handled=handled), schedule, danced.system


def carry_figures(log: RunLog, schedule: WalkingManipulation, system: System) -> dict[str, Any]:
    """What became of a box that was carried.

    Args:
        log: Rows of the run.
        schedule: Of the run.
        system: The robot and the things as they are simulated.
    """
    demonstration, clock = schedule.demonstration, schedule.played_times()
    start = system.coordinates[BOX].start - system.robot.nq
    at = log.thing_q[:, start : start + 3]
    path = demonstration.things[BOX]
    held = np.array([bool(sets.holding) for _, sets in schedule.history])
    rows = held[np.searchsorted([t for t, _ in schedule.history], log.time, side="right") - 1]
    wanted = np.array([path(t).position for t in clock[rows].tolist()]).reshape(-1, 3)
    off = np.linalg.norm((at[rows] - wanted)[:, :2], axis=1)
    return {
        "objects": object_report(log, system, demonstration),
        "tick_median_us": tick_medians(log, schedule.history),
        "manipulation": manipulation_figures(schedule),
        "carrying": {
            "way_m": float(
                np.linalg.norm(np.diff(at[rows][:: max(1, round(0.1 / log.period))], axis=0)[:, :2], axis=1).sum()
            ),
            "off_way_max_m": float(off.max()) if len(off) else None,
            "steps": sum(len(phase.feet) == 1 for phase in demonstration.motion.phases),
        },
    }


def sentence(figures: dict[str, Any]) -> str:
    """What became of the way, for a reader."""
    off = figures["off_way_max_m"]
    where = "the box was never held" if off is None else f"the box up to {1e3 * off:.0f} mm beside its planned way"
    return f"carried along {figures['way_m']:.2f} m, {figures['steps']} steps planned, {where}"
