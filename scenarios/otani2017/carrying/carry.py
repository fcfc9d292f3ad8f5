"""`sot run otani carry`: a box taken from a stand, carried on the robot's own steps, and set down on another one."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from scenarios.inputs.clips import find_clip
from scenarios.inputs.stack_file import Composition
from scenarios.otani2017.carrying.clip import ClipCarry, carry_after
from scenarios.otani2017.carrying.clip_figures import clip_figures
from scenarios.otani2017.carrying.scene import BOX, carry_demonstration, carry_things
from scenarios.otani2017.carrying.stack import carry_stack
from scenarios.otani2017.figures import manipulation_figures, object_report, tick_medians
from scenarios.otani2017.handling_stack import contacts_of
from scenarios.otani2017.scene import ObjectOptions, random_offset
from scenarios.replay import Dance, ProgressCallback, Replay, check_writable, make_solver, run_motion, write_outputs
from sim.recording.things import HandledThings
from sim.reporting import report
from sot.behaviours.manipulation.walking import WalkingManipulation
from sot.errors import InputError
from sot.motion.carrying.carry import CarryPlan, carry
from sot.motion.feet.footwork import Foothold
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.system import System
from sot.robots.things.thing import Thing

BOX_LEGS = (1.0 / 3.0, 0.57, 1.0 / 3.0)
"""Size of the box: forward, to the side and up, as it is held [leg lengths]."""
BACK_LEGS, AHEAD_LEGS = 2.0 / 3.0, 8.0 / 3.0
"""Way of the body back from the first stand, and ahead to the second one after a quarter of a turn to the left [leg
lengths]."""
NOISE_M, NOISE_DEG = 0.003, 2.0
"""Standard deviation of where the box stands, with a seed: in each direction [m], and in its heading [deg]."""
FIGURE_PERIOD_S = 0.02
"""Time between the samples of which figures are taken [s]."""


@dataclass(frozen=True)
class Carrying:
    """A box that is carried, after a clip if one is given, else from stand to stand.

    Attributes:
        actual: What the box is like in physics.
        believed: What the controller takes it to be like; as it is unless given.
        seed: Of the noise of its place; none without.
    """

    actual: ObjectOptions = field(default_factory=lambda: ObjectOptions(mass=2.0))
    believed: ObjectOptions | None = None
    seed: int | None = None

    takes_clip: ClassVar[bool] = True


@dataclass(frozen=True)
class Carried:
    """A box was carried, or not.

    Attributes:
        danced: The run.
        schedule: Of the run.
        system: The robot and the things as they are simulated.
        after: The clip's carrying, if it was one.
    """

    danced: Dance
    schedule: WalkingManipulation
    system: System
    after: ClipCarry | None


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
    done = perform(request, carrying, tell)
    return write_outputs(done.danced, out, tell, report.rounded(carry_figures(done)))


def perform(request: Replay, carrying: Carrying, tell: ProgressCallback) -> Carried:
    """Plan the carrying of a box and run it; nothing is written.

    Args:
        request: Robot, solver and rate.
        carrying: What is carried.
        tell: Told of the progress.
    """
    robot, believed = Robot.load(request.robot), carrying.believed or carrying.actual
    if request.start or request.duration is not None:
        raise InputError("otani carry takes a clip whole: leave --start and --duration out")
    random = None if carrying.seed is None else np.random.default_rng(carrying.seed)
    offset = None if random is None else random_offset(random, NOISE_M, float(np.radians(NOISE_DEG)))
    tell("planning", None)
    after = None
    if request.clip:
        after = carry_after(find_clip(request.clip), robot, believed.mass, request.rate)
        plan = after.carry
    else:
        left, leg = 0.5 * np.pi, leg_length(robot)
        back, ahead = -BACK_LEGS * leg, AHEAD_LEGS * leg
        stops = [Foothold(back, 0.0, 0.0), Foothold(back, 0.0, left), Foothold(back, ahead, left)]
        depth, width, height = (leg * length for length in BOX_LEGS)
        plan = carry(robot, (depth, width, height), believed.mass, stops, request.rate)
    system = System(robot, carry_things(plan, believed, stands=after is None))
    things = carry_things(plan, carrying.actual, offset, stands=after is None)
    return carry_out(replace(request, clip=request.clip or "carry"), plan, system, things, tell, after)


def carry_out(
    request: Replay,
    plan: CarryPlan,
    system: System,
    things: Sequence[Thing],
    tell: ProgressCallback,
    after: ClipCarry | None = None,
) -> Carried:
    """Run a planned carrying; nothing is written.

    Args:
        request: Solver and rate, and what the run is called.
        plan: What is to be done.
        system: The robot and the things as the controller knows them.
        things: As they are in physics.
        tell: Told of the progress.
        after: The clip's carrying, if it is one.
    """
    demonstration = carry_demonstration(plan, system)
    contacts = contacts_of(demonstration)
    schedule = WalkingManipulation(demonstration, contacts)

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(carry_stack(demonstration, contacts, schedule), schedule)

    danced = run_motion(request, compose, demonstration.motion, None, tell, system=system, things=things)
    played = schedule.played()
    danced.run.log.zmp_planned[: len(played.zmp)] = played.zmp  # the run knew the motion only as it is without waits
    assert danced.system is not None
    handled = HandledThings(schedule.history, schedule.played_times())
    remarks = (*(after.remarks if after else ()), *danced.remarks)
    return Carried(replace(danced, motion=played, handled=handled, remarks=remarks), schedule, danced.system, after)


def carry_figures(done: Carried) -> dict[str, Any]:
    """What became of a box that was carried."""
    log, schedule, system = done.danced.run.log.trimmed(), done.schedule, done.system
    demonstration, clock = schedule.demonstration, schedule.played_times()
    start = system.coordinates[BOX].start - system.robot.nq
    held = np.array([bool(sets.holding) for _, sets in schedule.history])
    rows = np.flatnonzero(held[np.searchsorted([t for t, _ in schedule.history], log.time, side="right") - 1])
    rows = rows[:: max(1, round(FIGURE_PERIOD_S / log.period))]
    at, path = log.thing_q[rows, start : start + 2], demonstration.things[BOX]
    off = np.linalg.norm(at - np.array([path(t).position[:2] for t in clock[rows].tolist()]).reshape(-1, 2), axis=1)
    figures = {
        "carried_m": float(np.linalg.norm(at[-1] - at[0])) if len(at) else 0.0,
        "off_way_max_m": float(off.max()) if len(off) else None,
        "steps": sum(len(phase.feet) == 1 for phase in demonstration.motion.phases),
    }
    if done.after is not None:
        figures |= clip_figures(done.after, log, rows, at, clock, system.robot)
    return {
        "objects": object_report(log, system, demonstration),
        "tick_median_us": tick_medians(log, schedule.history),
        "manipulation": manipulation_figures(schedule),
        "carrying": figures,
    }


def sentence(figures: dict[str, Any]) -> str:
    """What became of the way, for a reader."""
    off = figures["off_way_max_m"]
    where = "the box was never held" if off is None else f"the box up to {1e3 * off:.0f} mm beside its planned way"
    words = f"carried {figures['carried_m']:.2f} m far, {figures['steps']} steps planned, {where}"
    if "off_clip_max_m" in figures:
        words += (
            f", {1e3 * figures['off_clip_max_m']:.0f} mm beside the clip's in the robot's size; upper body"
            f" {figures['upper_body_mpjpe_mm']:.0f} mm off its reference in the mean,"
            f" {figures['upper_body_human_mm']:.0f} mm off the human in the robot's size, limb by limb"
        )
    return words
