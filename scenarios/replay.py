"""Replay of a clip by a robot under physics: from the file to the recording and the report."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import Any

from scenarios import stacks
from scenarios.inputs import clips, edit_file
from scenarios.inputs.dancer import check_format, incoming_quality, requested_human
from scenarios.inputs.plant import STEPPING, estimator_of, hardware_of, position_controller
from scenarios.inputs.stack_file import Composer, Composition, blaming_stack_file, load_stack
from sim.drivers import PositionController
from sim.log import RunInfo
from sim.loop import Run, run
from sim.mismatch import NO_MISMATCH, Mismatch
from sim.own_scene import Scene
from sim.push import Push
from sim.recording import recorder
from sim.recording.things import HandledThings
from sim.reporting import report, timeline
from sim.reporting.simulated import simulated_motion
from sim.reporting.traces import Traces
from sim.world import World
from solvers import Cascade, Solver, TaskCorrection, Weighted
from sot.control.controller import Controller, compile_ticks
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.errors import InputError
from sot.hardware.compliance import FootCompliance
from sot.hardware.hardware import Hardware
from sot.motion.feet import contact_file
from sot.motion.performance import Performance
from sot.motion.plan import Plan, plan
from sot.motion.trajectory import Motion, is_motion_file
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.robots.things.thing import Thing
from sot.servo.soft_feet import refuse_soft_feet
from sot.whole_file import atomic_write
from tasks.editing import edit

ProgressCallback = Callable[[str, float | None], object]
"""Function that is told the current step in words, and the share of it that is done, if known."""

SOLVERS: dict[str, Callable[[], Solver]] = {"cascade": Cascade, "weighted": Weighted, "iktc": TaskCorrection}
RECORDING_FILE, REPORT_FILE, TIMELINE_FILE, TRACES_FILE = "run.rrd", "report.json", "schedule.svg", "traces.npz"
SIMULATED_FILE = "simulated.npz"


@dataclass(frozen=True)
class Replay:
    """Request to replay a clip.

    Attributes:
        clip: file or name of a clip, or a motion that `sot retarget` wrote (`.npz`).
        robot: name of a robot, or its file.
        stack: file of the user's own stack; None for the one that fits the feet.
        solver: one of `SOLVERS`.
        feet: one of `sot.motion.plan.FEET_MODES`.
        start, duration: part of the clip [s], to its end by default.
        rate: of the control [Hz].
        mapping: file that names the joints of an unknown skeleton.
        contacts: file of the steps to make, instead of those found in the clip.
        pushes: forces on the robot while it dances.
        mismatch: how the simulated robot and floor differ from what the controller knows.
        edits: file of edits of the dance.
        up, forward: axes of the clip's file, of `sot.motion.human.world.UP_AXES`; found in the clip by default.
        unit: of the clip's file, one of `sot.motion.human.world.METRES_PER_UNIT`; found in the clip by default.
        plant: one of `scenarios.inputs.plant.PLANTS`: whether joints take torques or have servos that take positions.
        compliance: of the robot's feet; rigid by default.
        stabiliser: one of `scenarios.inputs.plant.STABILISERS`, for a robot with servos.
        state: one of `scenarios.inputs.plant.STATES`: what the controller is told.
        sensors: one of `sot.hardware.sensors.SENSOR_PRESETS`.
        from_format: of a robot's motion that becomes the clip, one of `sot.exchange.registry.FORMATS`; a human's clip
            unless given.
        fps: frame rate of that motion [Hz], where its file does not say.
        as_danced: whether the clip's time and way are kept, as `sot.motion.plan.plan` does.
    """

    clip: str
    robot: str = "hrp2"
    stack: Path | None = None
    solver: str = "cascade"
    feet: str = "planted"
    start: float = 0.0
    duration: float | None = None
    rate: float = 1000.0
    mapping: Path | None = None
    pushes: tuple[Push, ...] = ()
    mismatch: Mismatch = NO_MISMATCH
    contacts: Path | None = None
    edits: Path | None = None
    up: str | None = None
    forward: str | None = None
    unit: str | None = None
    plant: str = "torque"
    compliance: FootCompliance | None = None
    stabiliser: str = "dcm"
    state: str = "true"
    sensors: str = "ideal"
    from_format: str | None = None
    fps: float | None = None
    as_danced: bool = False

    def hardware(self, robot: Robot) -> Hardware:
        """What is asked for beside links and motors of a robot.

        Raises:
            InputError: that does not exist.
        """
        seed = self.mismatch.seed
        return hardware_of(robot, self.plant, self.compliance, self.state, self.sensors, seed)


@dataclass(frozen=True)
class Dance:
    """Result of a dance.

    Attributes:
        run: the rows of the log, and how it ended.
        info: what was asked for.
        motion: the reference.
        plan: how the reference came from a human; None if it came from a file.
        edits: a line for each edit of the dance.
        scene: what was in the world besides robot and floor.
        system: robot and things as they were simulated, if there were any.
        handled: how the robot handled them, if it did.
        remarks: what happened otherwise than planned, a sentence each.
    """

    run: Run
    info: RunInfo
    motion: Motion
    plan: Performance | None
    edits: tuple[str, ...] = ()
    scene: Scene | None = None
    system: System | None = None
    handled: HandledThings | None = None
    remarks: tuple[str, ...] = ()

    def write_recording(self, path: Path) -> float:
        """Write the recording; returns how long that took [s]."""
        begun = perf_counter()
        shown = self.scene, self.system, self.handled
        recorder.write_recording(path, self.run.log, self.info, self.motion, self.plan, *shown)
        return perf_counter() - begun


def replay(request: Replay, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Plan, run, record and report; the files appear in the folder `out` when all is done.

    Returns:
        The report.

    Raises:
        InputError: anything in the request that does not fit; nothing is written then.
    """
    check_writable(out)
    danced = dance(request, tell)
    incoming = incoming_quality(request, danced.motion.robot)
    return write_outputs(danced, out, tell, {"incoming": report.rounded(incoming)} if incoming else {})


def write_outputs(
    danced: Dance, out: Path, tell: ProgressCallback, extra_figures: Mapping[str, Any] = MappingProxyType({})
) -> dict[str, Any]:
    """Write the recording and the report of a dance, with extra figures, to the folder `out`; returns the report."""
    tell("recording", None)
    out.mkdir(parents=True, exist_ok=True)
    wall = danced.run.wall_s + danced.write_recording(out / RECORDING_FILE)
    if timeline.has_changes(danced.run.log):
        timeline.write_timeline(out / TIMELINE_FILE, danced.run.log, danced.info, danced.motion.robot)
    figures = report.run_report(danced.run.log, danced.info, wall, danced.motion, danced.plan)
    figures["remarks"] = [*figures["remarks"], *danced.remarks]
    figures |= {"edits": list(danced.edits)} | dict(extra_figures)
    report.write_json(figures, out / REPORT_FILE)
    Traces.of(danced.run.log, danced.info, danced.motion).save(out / TRACES_FILE)
    simulated_motion(danced.run.log, danced.info, danced.motion, danced.plan).save(out / SIMULATED_FILE)
    return figures


def dance(request: Replay, tell: ProgressCallback) -> Dance:
    """Plan and run; nothing is written.

    Raises:
        InputError: anything in the request that does not fit.
    """
    make_solver(request.solver)  # before any work
    check_format(request)
    robot = Robot.load(request.robot)
    hardware = request.hardware(robot)
    if hardware.servo is not None and request.stabiliser != STEPPING and not (request.stack or request.edits):
        motion, planned = reference_motion(request, robot, tell)
        controller = position_controller(request.stabiliser, motion, hardware, 1.0 / request.rate)
        return run_on_servos(request, controller, motion, planned, tell)
    edits = edit_file.read_edits(request.edits) if request.edits else ()
    for one in edits:
        one.check(robot)
    compose = load_stack(request.stack) if request.stack else partial(_default_stack, request.stabiliser)

    def compose_edited(robot: Robot, motion: Motion) -> Composition:
        composition = compose(robot, motion)
        return composition._replace(edits=composition.edits + edits)

    return run_motion(request, compose_edited, *reference_motion(request, robot, tell), tell)


def run_motion(
    request: Replay,
    compose: Composer,
    motion: Motion,
    planned: Plan | None,
    tell: ProgressCallback,
    scene: Scene | None = None,
    solver: Solver | None = None,
    system: System | None = None,
    things: Sequence[Thing] = (),
) -> Dance:
    """Run a stack on a planned motion under physics; where joints have servos, its accelerations are integrated.

    Args:
        request: what was asked for.
        compose: makes the stack for the motion.
        motion: the reference.
        planned: how it came from a human, if it did.
        tell: told of the progress.
        scene: what is in the world besides robot and floor.
        solver: unless given, the one that the request names.
        system: the robot with the things that the controller knows of; the robot alone unless given.
        things: what is in the world to be handled; what the controller does not know of comes last.

    Raises:
        InputError: anything in the request that does not fit.
    """
    robot, solver = motion.robot, solver or make_solver(request.solver)
    stack, schedule, told = composed_stack(request, compose, motion)
    controller = Controller(system or robot, stack, solver, period=1.0 / request.rate, schedule=schedule)
    with blaming_stack_file(request.stack):
        world = _world(request, motion, scene, things)
    tell("starting (the first time on a machine this compiles, for half a minute)", None)
    _compile_tick(motion)
    runs: Controller | PositionController = controller
    if world.hardware.servo is not None:
        runs = position_controller(request.stabiliser, motion, world.hardware, 1.0 / request.rate, controller)
    with blaming_stack_file(request.stack):
        estimator = estimator_of(robot, world.hardware, request.state)
        done = run(runs, world, motion, lambda t: tell("replaying", t / motion.duration), estimator=estimator)
    info = _info(request, world, planned, done, solver.name)
    remarks = () if schedule is None else tuple(schedule.remarks())
    simulated = System(robot, things) if things else None
    return Dance(done, info, motion, planned, told, scene, simulated, remarks=remarks)


def run_on_servos(
    request: Replay, controller: PositionController, motion: Motion, planned: Plan | None, tell: ProgressCallback
) -> Dance:
    """Run a position controller along a planned motion, on a robot with servos, under physics.

    Raises:
        InputError: anything in the request that does not fit.
    """
    world = _world(request, motion)
    estimator = estimator_of(motion.robot, world.hardware, request.state)
    done = run(controller, world, motion, lambda t: tell("replaying", t / motion.duration), estimator=estimator)
    return Dance(done, _info(request, world, planned, done, request.stabiliser), motion, planned)


def _world(request: Replay, motion: Motion, scene: Scene | None = None, things: Sequence[Thing] = ()) -> World:
    """The world that a request asks for."""
    robot = motion.robot
    hardware = request.hardware(robot)
    if request.compliance is not None:
        refuse_soft_feet(request.compliance, motion)
    return World(robot, 1.0 / request.rate, request.mismatch, request.pushes, scene, things, hardware=hardware)


def _info(request: Replay, world: World, planned: Plan | None, done: Run, solver: str) -> RunInfo:
    source, licence = clips.terms(request.clip)
    return RunInfo(
        clip=Path(request.clip).stem,
        robot=world.robot.name,
        solver=solver,
        feet=request.feet,
        rate_hz=request.rate,
        fell_at_s=done.fell_at_s,
        speed_min=planned.speed_min if planned else 1.0,
        stretched_s=planned.added_time if planned else 0.0,
        reason=done.reason,
        mismatch=request.mismatch,
        pushes=request.pushes,
        hardware=world.hardware,
        source=source,
        licence=licence,
    )


def composed_stack(
    request: Replay, compose: Composer, motion: Motion
) -> tuple[Stack, Schedule | None, tuple[str, ...]]:
    """A stack for a motion, its changes over time, edits among them, and a line for each edit.

    Raises:
        InputError: anything that does not fit the motion.
    """
    stack, schedule, edits = compose(motion.robot, motion)
    if not edits:
        return stack, schedule, ()
    schedule = schedule or Schedule()
    with blaming_stack_file(request.stack):
        return stack, schedule, tuple(edit(stack, schedule, motion, edits))


def _compile_tick(motion: Motion) -> None:
    """Compile the functions of a tick by running some, untimed, in a controller of its own."""
    controller = Controller(motion.robot, stacks.planted_stack(motion.robot, motion), Cascade())
    compile_ticks(controller, 0.0, motion.q[0])


def retarget(request: Replay, out: Path, tell: ProgressCallback) -> Plan:
    """Plan the robot's motion for a clip and write it to the file `out` (`.npz`), or the dancer's steps (`.toml`).

    Raises:
        InputError: anything in the request that does not fit; nothing is written then.
    """
    if out.suffix not in (".npz", ".toml"):
        raise InputError(f"{out}: a motion is written to a file that ends in .npz, and its steps to one in .toml")
    if out.suffix == ".toml" and request.feet == "planted":
        raise InputError(f"{out}: planted feet make no steps to write: choose --feet steps, or a file in .npz")
    check_writable(out.parent)
    check_format(request)
    robot = Robot.load(request.robot)
    planned = _plan_of_clip(request, robot, tell)
    out.parent.mkdir(parents=True, exist_ok=True)
    if out.suffix == ".toml":
        contact_file.write(out, planned.travel.dancer if planned.travel else ())
        return planned
    with atomic_write(out) as place:
        planned.motion.save(place)
    return planned


def make_solver(name: str) -> Solver:
    """A solver by its name.

    Raises:
        InputError: no such solver.
    """
    if name not in SOLVERS:
        raise InputError(f"unknown solver '{name}': choose one of {', '.join(SOLVERS)}")
    return SOLVERS[name]()


def check_writable(folder: Path) -> None:
    """Check that files can be written to a folder, which need not exist yet; leaves nothing there.

    Raises:
        InputError: they cannot.
    """
    existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    try:
        tempfile.TemporaryFile(dir=existing).close()
    except OSError as error:
        raise InputError(f"{folder}: cannot write there ({error.strerror}); choose another output folder") from error


def _default_stack(stabiliser: str, robot: Robot, motion: Motion) -> Composition:
    """The stack that fits the motion's feet and what it leads."""
    if any(phase.sliding for phase in motion.phases):
        return Composition(stacks.sliding_stack(robot, motion), stacks.sliding_schedule(robot, motion))
    made = stacks.catching_stack if stabiliser == STEPPING else stacks.stepping_stack
    return Composition(made(robot, motion), stacks.stepping_schedule(robot, motion))


def reference_motion(request: Replay, robot: Robot, tell: ProgressCallback) -> tuple[Motion, Plan | None]:
    """The reference that a request names, planned now unless the clip is a motion already.

    Raises:
        InputError: a clip, its part, steps or a motion that cannot be used.
    """
    if request.from_format or not is_motion_file(clips.find_clip(request.clip)):
        planned = _plan_of_clip(request, robot, tell)
        return planned.motion, planned
    if request.start or request.duration is not None:
        raise InputError(f"{request.clip}: a planned motion, at rest at both ends, is replayed whole; cut the clip")
    return Motion.load(clips.find_clip(request.clip), robot), None


def _plan_of_clip(request: Replay, robot: Robot, tell: ProgressCallback) -> Plan:
    tell("reading", None)
    human = requested_human(request, robot)
    tell("planning", None)
    contacts = contact_file.read(request.contacts) if request.contacts else None
    return plan(human, robot, request.feet, request.rate, contacts, as_danced=request.as_danced)
