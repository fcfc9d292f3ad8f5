"""A bag fetched from a table: plan, run, record and report."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import mujoco
import numpy as np
import pinocchio as pin
from rich.console import Console

from scenarios.inputs.stack_file import Composition
from scenarios.otani2017.bag import picture
from scenarios.otani2017.bag.figures import bag_figures, foreign_touches
from scenarios.otani2017.bag.scene import BagPlan, bag_things
from scenarios.otani2017.bag.schedule import BagSchedule
from scenarios.otani2017.bag.stack import bag_contacts, bag_stack
from scenarios.replay import Dance, ProgressCallback, Replay, check_writable, make_solver, run_motion, write_outputs
from sim.recording.things import HandledThings
from sim.reporting import report
from sot.motion.objects.events import ContactSets
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.system import System

Array = np.ndarray

MASS_KG = 1.5
"""Mass of the bag unless another is asked for [kg]."""
NOISE_M, NOISE_DEG = 0.003, 2.0
"""Standard deviation of where the bag stands, with a seed: in each direction [m], and in its heading [deg]."""
PALM_PAD = "right_palm"


@dataclass(frozen=True)
class BagTrial:
    """What is fetched, and what differs from what the robot is told.

    Attributes:
        mass: Of the bag [kg].
        seed: Of the noise of the bag's place; none without.
        lower: By how much the table is lower than told [m].
        palm_friction: Coulomb coefficient of the table under the palm; the rubber's own unless given.
    """

    mass: float = MASS_KG
    seed: int | None = None
    lower: float = 0.0
    palm_friction: float | None = None

    takes_clip: ClassVar[bool] = False

    def offset(self) -> pin.SE3:
        """By how much the bag is off its place, in its own axes."""
        if self.seed is None:
            return pin.SE3.Identity()
        random = np.random.default_rng(self.seed)
        shift = NOISE_M * random.standard_normal(2)
        turn = np.radians(NOISE_DEG) * random.standard_normal()
        return pin.SE3(pin.exp3(np.array([0.0, 0.0, turn])), np.array([*shift, 0.0]))

    def change(self, spec: mujoco.MjSpec) -> None:
        """Make the table slippery under the palm."""
        if self.palm_friction is not None:
            spec.geom(PALM_PAD).friction[0] = self.palm_friction


def perform(request: Replay, trial: BagTrial, tell: ProgressCallback) -> tuple[Dance, BagSchedule]:
    """Plan and run; nothing is written.

    Raises:
        InputError: The robot has no palm or hook, or cannot lean that far.
    """
    robot = Robot.load(request.robot)
    tell("planning", None)
    system = System(robot, bag_things(robot, trial.mass))
    contacts = bag_contacts(system)
    schedule = BagSchedule(robot, BagPlan.of(system), contacts)
    stack = bag_stack(system, contacts, schedule)
    motion = Motion.standing(robot, 1.0, request.rate)
    danced = run_motion(
        replace(request, clip="bag"),
        lambda robot, motion: Composition(stack, schedule),
        motion,
        None,
        tell,
        scene=trial.change,
        system=system,
        things=bag_things(robot, trial.mass, trial.offset(), trial.lower),
    )
    log = danced.run.log
    led = np.array(schedule.led[: log.ticks])
    log.zmp_planned[: len(led)] = [schedule.zmp_of(place[0], place[2]) for place in led]
    played = _played(Motion.standing(robot, (log.ticks - 1) / request.rate, request.rate), led)
    handled = HandledThings(contact_history(danced), log.time[: log.ticks])
    return replace(danced, motion=played, handled=handled, scene=None), schedule


def run(request: Replay, trial: BagTrial, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Fetch the bag, record and report.

    Raises:
        InputError: Anything in the request that does not fit; nothing is written then.
    """
    check_writable(out)
    make_solver(request.solver)
    danced, schedule = perform(request, trial, tell)
    assert danced.system is not None
    figures = write_outputs(danced, out, tell, report.rounded({"bag": trial_figures(danced, schedule)}))
    title = f"a bag of {trial.mass:g} kg, by {danced.system.robot.label}"
    picture.draw(out / picture.PICTURE_FILE, danced.run.log.trimmed(), schedule.plan, title)
    return figures


def trial_figures(danced: Dance, schedule: BagSchedule) -> dict[str, Any]:
    """What became of the bag."""
    assert danced.system is not None
    log = danced.run.log.trimmed()
    figures = bag_figures(log, danced.system, schedule.plan, schedule.history, schedule.failure)
    return figures | {"foreign_touches": foreign_touches(log, danced.system)}


def contact_history(danced: Dance) -> list[tuple[float, ContactSets]]:
    """When the sets of contacts changed, and to what."""
    log = danced.run.log.trimmed()
    made = log.contact_mode != 0
    changes = [0, *(np.flatnonzero((made[1:] != made[:-1]).any(axis=1)) + 1).tolist()]
    return [(float(log.time[k]), _sets(log.contact_names, made[k])) for k in changes]


def _sets(names: Sequence[str], made: Array) -> ContactSets:
    """The sets of what is made; names of contacts are those of `bag_contacts`."""
    links = {name: name.partition(" on ")[0] for name in names}
    supports = {links[n] for n, on in zip(names, made, strict=True) if on and ("/" not in n or " on table/" in n)}
    holding = {links[n] for n, on in zip(names, made, strict=True) if on and " on bag/" in n}
    of_robot = {link for link in links.values() if "/" not in link}
    supports &= of_robot
    return ContactSets(frozenset(supports), frozenset(of_robot - supports - holding), frozenset(holding), frozenset())


def _played(motion: Motion, led: Array) -> Motion:
    """The standing motion with the centre of mass as it was led (T, 3, 2)."""
    height = motion.com[: len(led), 2:]
    nothing = np.zeros_like(height)
    return replace(
        motion,
        com=np.hstack([led[:, 0], height]),
        com_velocity=np.hstack([led[:, 1], nothing]),
        com_acceleration=np.hstack([led[:, 2], nothing]),
        zmp=led[:, 0].copy(),
    )


def show(figures: dict[str, Any], console: Console) -> None:
    """Print what became of the bag."""
    own = figures["bag"]
    lines = [
        f"bag of {own['mass_kg']:.2g} kg: {own['outcome']}",
        f"centre of mass up to {1e3 * own['beyond_sole_max_m']:.0f} mm beyond the sole",
        f"hand up to {own['palm_force_max_n']:.0f} N, measured off what was commanded by"
        f" {100 * own['palm_force_error']:.1f} %"
        if own["palm_force_max_n"]
        else "the hand bore nothing",
        f"other touches: {', '.join(own['foreign_touches']) or 'none'}",
    ]
    for line in lines:
        console.print(line, highlight=False, soft_wrap=True)
