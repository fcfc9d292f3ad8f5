"""A box carried over one leg and a door pushed open after one human; bag, box and cart without any: Otani 2017, IV."""

from dataclasses import dataclass, field, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.inputs.clips import find_clip
from scenarios.inputs.stack_file import Composition
from scenarios.otani2017 import curves, pictures
from scenarios.otani2017.bag import bag
from scenarios.otani2017.bag.bag import BagTrial
from scenarios.otani2017.carrying import carry, cart
from scenarios.otani2017.carrying.carry import Carrying
from scenarios.otani2017.carrying.cart import Pushing
from scenarios.otani2017.figures import manipulation_figures, object_report, tick_medians
from scenarios.otani2017.handling_stack import contacts_of, handling_stack
from scenarios.otani2017.scene import ObjectOptions, placement_noise, scene_things
from scenarios.replay import Dance, ProgressCallback, Replay, check_writable, make_solver, run_motion, write_outputs
from sim.recording.things import HandledThings
from sim.reporting import report
from sot.behaviours.manipulation.schedule import ManipulationSchedule
from sot.errors import InputError
from sot.motion import Human, read, recognise
from sot.motion.feet.stance import Build
from sot.motion.objects import event_file
from sot.motion.objects.demonstration import HandledObjects, read_objects
from sot.motion.objects.events import ContactPlan
from sot.motion.objects.pushing import paced_for_pushing
from sot.motion.objects.retarget import Scale, retarget_objects
from sot.motion.plan import imitation
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.system import System

STUDIES = ("box", "door")
NOISE_M, NOISE_DEG = 0.003, 2.0
"""Standard deviation of where a free thing stands, with a seed: in each direction [m], and in its heading [deg]."""
UNKNOWN_SHARE = 1e-2
"""Share of its mass that a thing has for a controller that does not know of it."""
DATA = Path(str(files("scenarios.inputs"))) / "data"


@dataclass(frozen=True)
class Handling:
    """What is handled, and what the controller knows of it.

    Attributes:
        study: "box" or "door".
        from_plate: Whether the box stands on a low plate on the floor, not on a stand.
        actual: What the things are like in physics.
        believed: What the controller takes them to be like; as they are unless given.
        unknown: Whether the things weigh and resist next to nothing for the controller: out of the program.
        seed: Of the noise of the things' places; none without.
        events: File of contact events in the place of the demonstration's.
    """

    study: str
    from_plate: bool = False
    actual: ObjectOptions = field(default_factory=ObjectOptions)
    believed: ObjectOptions | None = None
    unknown: bool = False
    seed: int | None = None
    events: Path | None = None

    takes_clip: ClassVar[bool] = False
    """Demonstrations are its own."""

    @property
    def clip(self) -> str:
        """Name of the demonstration."""
        return "door" if self.study == "door" else "box_plate" if self.from_plate else "box_stand"

    def known(self) -> ObjectOptions:
        """What the controller takes the things to be like."""
        known = self.believed or self.actual
        return replace(known, stiffness=0.0, damping=0.0) if self.unknown and self.study == "door" else known


DEFAULT_OPTIONS = Handling(STUDIES[0])


def run(
    request: Replay, handling: Handling | BagTrial | Carrying | Pushing, out: Path, tell: ProgressCallback
) -> dict[str, Any]:
    """Retarget a demonstration, or plan what has none, run it, record and report.

    Args:
        request: Robot, solver, rate, pushes and mismatch.
        handling: The rest of what is asked for.
        out: Folder to write to.
        tell: Told of the progress.

    Raises:
        InputError: Anything in the request that does not fit; nothing is written then.
    """
    if isinstance(handling, BagTrial):
        return bag.run(request, handling, out, tell)
    if isinstance(handling, Carrying):
        return carry.run(request, handling, out, tell)
    if isinstance(handling, Pushing):
        return cart.run(request, handling, out, tell)
    check_writable(out)
    make_solver(request.solver)
    danced, schedule, system = perform(request, handling, tell)
    log = danced.run.log.trimmed()
    label = ", ".join(f"{value:g} {unit}" for value, unit in handling.actual.told(handling.study))
    drawn = curves.curves_of(log, system, schedule.played_times(), label)
    extra = {
        "objects": object_report(log, system, schedule.demonstration),
        "tick_median_us": tick_medians(log, schedule.history),
        "legs": curves.leg_figures(drawn, system.robot, schedule.history),
        "manipulation": manipulation_figures(schedule),
    }
    figures = write_outputs(danced, out, tell, report.rounded(extra))
    curves.save_curves(out / curves.CURVES_FILE, drawn)
    pictures.draw(out / pictures.PICTURE_FILE, [drawn], f"{handling.clip}, {label}, by {system.robot.label}")
    return figures


def perform(request: Replay, handling: Handling, tell: ProgressCallback) -> tuple[Dance, ManipulationSchedule, System]:
    """Retarget a demonstration and run it; nothing is written.

    Returns:
        The run, its schedule, and the robot with the things as they are simulated.
    """
    if handling.study not in STUDIES:
        raise InputError(f"otani has no study '{handling.study}': choose {' or '.join(STUDIES)}")
    robot = Robot.load(request.robot)
    tell("reading", None)
    human, handled, contacts = read_demonstration(handling)
    tell("planning", None)
    scale = Scale.of(human, Build.of(robot))
    offsets = (
        None
        if handling.seed is None
        else placement_noise(handled, handling.seed, NOISE_M, float(np.radians(NOISE_DEG)))
    )
    actual = scene_things(handled, scale, handling.actual, offsets)
    believed = scene_things(handled, scale, handling.known(), share=UNKNOWN_SHARE if handling.unknown else 1.0)
    system = System(robot, believed)
    # A controller that knows no object cannot know how fast it may be pushed.
    paced = paced_for_pushing(human, handled, contacts, () if handling.unknown else believed)
    human, handled, contacts = paced.human, paced.handled, paced.contacts
    demonstration = retarget_objects(
        human, handled, contacts, imitation(human, robot, request.rate), system, hands_for(robot, handling.study)
    )
    pairs = contacts_of(demonstration)
    schedule = ManipulationSchedule(demonstration, pairs)

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(handling_stack(demonstration, pairs, schedule), schedule)

    danced = run_motion(
        replace(request, clip=handling.clip), compose, demonstration.motion, None, tell, system=system, things=actual
    )
    handled_things = HandledThings(schedule.history, schedule.played_times())
    played = schedule.played()
    danced.run.log.zmp_planned[: len(played.zmp)] = played.zmp  # the run knew the motion only as it is without waits
    remarks = (*paced.remarks, *danced.remarks)
    assert danced.system is not None
    return replace(danced, motion=played, handled=handled_things, remarks=remarks), schedule, danced.system


def read_demonstration(handling: Handling) -> tuple[Human, HandledObjects, ContactPlan]:
    """The human of a study, its objects, and its contacts."""
    human = recognise(read(find_clip(handling.clip)))
    handled = read_objects(DATA / f"{handling.clip}.objects.toml")
    contacts = event_file.read(handling.events or DATA / f"{handling.clip}.events.toml")
    return human.resampled(handled.rate), handled, contacts


def hands_for(robot: Robot, study: str) -> dict[str, str]:
    """Surface of the robot that each of the human's hands stands for.

    Raises:
        InputError: The robot has no such surface.
    """
    end = "hand_end" if study == "door" else "palm"
    hands = {f"{side}_hand": f"{side}_{end}" for side in ("left", "right")}
    for name in hands.values():
        robot.surface(name)
    return hands


def show(figures: dict[str, Any], console: Console) -> None:
    """Print what became of the things."""
    if "bag" in figures:
        bag.show(figures, console)
        return
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in (
        "thing",
        "mass, kg",
        "slip, mm",
        "greatest hand force, N",
        "off its place, mm",
        "tilt, deg",
        "turned, deg",
    ):
        table.add_column(words, justify="right" if words != "thing" else "left")
    for name, one in figures["objects"].items():
        table.add_row(
            name,
            _text(one["mass_kg"]),
            _text(one["slip_max_m"], 1e3),
            _text(one["hand_force_max_n"]),
            _text(one.get("end_error_m"), 1e3),
            _text(one["end_tilt_deg"]),
            _text(one["end_angle_deg"]),
        )
    console.print(table)
    if "legs" in figures:
        console.print(_leg_sentence(figures["legs"]), highlight=False, soft_wrap=True)
    if "carrying" in figures:
        console.print(carry.sentence(figures["carrying"]), highlight=False, soft_wrap=True)
    if "cart" in figures:
        console.print(cart.sentence(figures["cart"]), highlight=False, soft_wrap=True)
    held, without = (figures["tick_median_us"][words] for words in ("held", "without"))
    if held and without:
        ratio = f"a tick while hands hold something: {held / without:.2f} times one while they do not, in the median"
        console.print(ratio, highlight=False, soft_wrap=True)
    for wait in figures["manipulation"]["waits"]:
        console.print(
            f"waited {wait['end_s'] - wait['start_s']:.1f} s: {wait['events']}", highlight=False, soft_wrap=True
        )


def _leg_sentence(legs: dict[str, Any]) -> str:
    """Figures 7 and 8, or Figure 5, of a run."""
    when = f"from {legs['start_s']:.1f} to {legs['end_s']:.1f} s"
    if legs["over_one_leg"]:
        return (
            f"over one leg, {when}: left hip {_text(legs['left_hip_torque_mean_nm'])} and knee "
            f"{_text(legs['left_knee_torque_mean_nm'])} N m in the mean, right foot back by up to "
            f"{_text(legs['right_foot_back_max_m'], 1e3)} mm"
        )
    return (
        f"at the end, {when}: right ankle {_text(legs['right_ankle_torque_mean_nm'])} N m, hands "
        f"{_text(legs['hand_force_mean_n'])} N in the mean"
    )


def _text(value: float | None, factor: float = 1.0) -> str:
    return "-" if value is None else f"{factor * value:.3g}"
