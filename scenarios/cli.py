"""The command line, `sot`: its exit status is 0 done and upright, 1 fallen, 2 bad usage or input, 3 anything else."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from scenarios import viewer
from scenarios.bench_command import bench_command
from scenarios.humanoidbench import options as bench_cli
from scenarios.inputs import plant_options
from scenarios.inputs.clip_options import (
    Clip,
    Contacts,
    Duration,
    EditFile,
    Feet,
    ForwardAxis,
    FrameRate,
    FromFormat,
    MappingFile,
    Start,
    Unit,
    UpAxis,
)
from scenarios.inputs.disturbances import parse_mismatch, parse_push
from scenarios.inputs.plant import parse_feet_compliance
from scenarios.inputs.run_options import MismatchText, Pushes, Rate, RobotName, SolverName
from scenarios.kimoh2013.damping import options as damping_cli
from scenarios.library.commands import batch_command
from scenarios.library.export import export_command
from scenarios.listing import Kind, list_rows
from scenarios.live.commands import live_command, stream_command
from scenarios.otani2017 import options
from scenarios.page import write_page
from scenarios.replay import (
    RECORDING_FILE,
    Replay,
    replay,
    retarget,
)
from scenarios.robots.commands import robot_app
from scenarios.showing import print_remarks, progress, show_report
from scenarios.stairs import options as stairs_cli
from scenarios.studies import MOTION_SCENARIOS, default_solver, is_file, run_scenario
from scenarios.terminal import BAD_INPUT, DONE, FAILED, FELL, INTERRUPTED, messages, output
from sot.errors import InputError, UnknownSkeletonError

TRACEBACK_VARIABLE = "SOT_TRACEBACK"

app = typer.Typer(
    help="A human dances; a stack of prioritised tasks makes a torque-controlled humanoid dance it under physics.",
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.add_typer(robot_app, name="robot")
app.command("live")(live_command)
app.command("stream")(stream_command)
app.command("bench")(bench_command)
app.command("batch")(batch_command)
app.command("export")(export_command)


@app.command("replay")
def replay_command(
    clip: Clip,
    robot: RobotName = "hrp2",
    stack: Annotated[Path | None, typer.Option(help="Python file that defines stack(robot, motion).")] = None,
    solver: SolverName = "cascade",
    feet: Feet = "auto",
    start: Start = 0.0,
    duration: Duration = None,
    rate: Rate = 1000.0,
    mapping: MappingFile = None,
    up: UpAxis = None,
    forward: ForwardAxis = None,
    unit: Unit = None,
    contacts: Contacts = None,
    edit: EditFile = None,
    push: Pushes = None,
    mismatch: MismatchText = "",
    plant: plant_options.PlantName = "torque",
    feet_compliance: plant_options.Compliance = None,
    stabiliser: plant_options.StabiliserName = "dcm",
    state: plant_options.StateName = "true",
    sensors: plant_options.SensorsName = "ideal",
    from_format: FromFormat = None,
    fps: FrameRate = None,
    out: Annotated[Path | None, typer.Option(help="Folder for what it writes; runs/CLIP by default.")] = None,
    view: Annotated[bool, typer.Option("--view", help="Open the recording when done.")] = False,
) -> int:
    """Let a robot dance a clip under physics; record it and report on it."""
    if view:
        viewer.check_display()
    folder = out or Path("runs") / Path(clip).stem
    pushes = tuple(parse_push(text) for text in push or ())
    changed = parse_mismatch(mismatch)
    soft = parse_feet_compliance(feet_compliance) if feet_compliance is not None else None
    request = Replay(
        clip,
        robot,
        stack,
        solver,
        feet,
        start,
        duration,
        rate,
        mapping,
        pushes,
        changed,
        contacts,
        edit,
        up,
        forward,
        unit,
        plant,
        soft,
        stabiliser,
        state,
        sensors,
        from_format,
        fps,
    )
    with progress() as tell:
        report = replay(request, folder, tell)
    status = show_report(report, folder)
    if view:
        view_command(folder)
    return status


@app.command("run")
def run_command(
    scenario: Annotated[str, typer.Argument(help="A name of `sot list scenarios`, or a file of your own (.py).")],
    study: options.Study = None,
    clip: Annotated[
        str | None,
        typer.Option(help="For ramos, stairs and the studies of clips: a file, or a name of `sot list clips`."),
    ] = None,
    start: Start = 0.0,
    duration: Duration = None,
    robot: RobotName = "hrp2",
    solver: Annotated[str | None, typer.Option(help="A name of `sot list solvers`; the scenario's by default.")] = None,
    rate: Rate = 1000.0,
    push: Pushes = None,
    mismatch: MismatchText = "",
    plant: plant_options.PlantName = "torque",
    feet_compliance: plant_options.Compliance = None,
    stabiliser: plant_options.StabiliserName = "dcm",
    state: plant_options.StateName = "true",
    sensors: plant_options.SensorsName = "ideal",
    mass: options.Mass = None,
    stiffness: options.Stiffness = None,
    damping: options.Damping = None,
    friction: options.Friction = None,
    assumed_mass: options.AssumedMass = None,
    assumed_stiffness: options.AssumedStiffness = None,
    without_object: options.WithoutObject = False,
    from_plate: options.FromPlate = False,
    seed: options.Seed = None,
    events: options.Events = None,
    case: damping_cli.Case = None,
    damping_ratio: damping_cli.DampingRatio = None,
    form: damping_cli.Form = None,
    identified: damping_cli.IdentifiedFile = None,
    seeds: damping_cli.Seeds = None,
    rise: stairs_cli.Rise = None,
    depth: stairs_cli.Depth = None,
    treads: stairs_cli.Treads = None,
    slope: stairs_cli.Slope = None,
    out: Annotated[Path | None, typer.Option(help="Folder for what it writes; runs/NAME by default.")] = None,
) -> int:
    """Run a scenario; record it and report on it."""
    told = stiffness, damping, friction, assumed_mass, assumed_stiffness, without_object, from_plate, seed, events
    handling = options.handling_options(scenario, study, mass, *told)
    pendulum = case, damping_ratio, form, identified, seeds
    swaying = damping_cli.damping_options(scenario, study, *pendulum)
    climbing = stairs_cli.stairs_options(scenario, rise, depth, treads, slope, seed)
    benched = bench_cli.bench_options(scenario, study, seed)
    if seed is not None and handling is None and climbing is None and benched is None:
        known = f"{options.NAME}, {stairs_cli.NAME} and {bench_cli.NAME}"
        raise InputError(f"{scenario} takes no --seed: only {known} do")
    if study is not None and handling is None and swaying is None and benched is None:
        raise InputError(f"{scenario} takes no {study}: it has no studies to choose from")
    pushes, changed = tuple(parse_push(text) for text in push or ()), parse_mismatch(mismatch)
    chosen = solver or default_solver(scenario)
    request = Replay(
        "",
        robot,
        solver=chosen,
        feet="scenario",
        start=start,
        duration=duration,
        rate=rate,
        pushes=pushes,
        mismatch=changed,
        plant=plant,
        compliance=parse_feet_compliance(feet_compliance) if feet_compliance is not None else None,
        stabiliser=stabiliser,
        state=state,
        sensors=sensors,
    )
    folder = out or Path("runs") / Path(scenario).stem
    with progress() as tell:
        report, show_own = run_scenario(
            scenario, clip, request, folder, tell, handling or swaying or climbing or benched
        )
    status = FELL if report.get("fell") else DONE
    if (handling or climbing or benched) is not None or scenario in MOTION_SCENARIOS or is_file(scenario):
        status = show_report(report, folder)
    if show_own:
        show_own(report, output)
        output.print(f"\nWritten: {', '.join(str(path) for path in sorted(folder.iterdir()))}", soft_wrap=True)
    return status


@app.command("retarget")
def retarget_command(
    clip: Clip,
    robot: RobotName = "hrp2",
    feet: Feet = "auto",
    start: Start = 0.0,
    duration: Duration = None,
    rate: Rate = 1000.0,
    mapping: MappingFile = None,
    up: UpAxis = None,
    forward: ForwardAxis = None,
    unit: Unit = None,
    contacts: Contacts = None,
    from_format: FromFormat = None,
    fps: FrameRate = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write.")] = Path("motion.npz"),
) -> int:
    """Plan a robot's motion for a clip, without physics, and write it (.npz), or the dancer's steps (.toml), to a file
    that `sot replay` takes."""
    request = Replay(
        clip,
        robot,
        feet=feet,
        start=start,
        duration=duration,
        rate=rate,
        mapping=mapping,
        contacts=contacts,
        up=up,
        forward=forward,
        unit=unit,
        from_format=from_format,
        fps=fps,
    )
    with progress() as tell:
        planned = retarget(request, out, tell)
    if out.suffix == ".toml":
        output.print(f"{out}: {len(planned.travel.dancer) if planned.travel else 0} steps", soft_wrap=True)
        print_remarks(planned.remarks)
        return DONE
    figures = planned.retarget
    output.print(
        f"{out}: {planned.motion.duration:.2f} s for {planned.motion.robot.label}, key points "
        f"{1e3 * figures['key_point_rms_m']:.0f} mm from the scaled human's, {figures['frames_per_s']:.0f} frames/s",
        soft_wrap=True,
    )
    print_remarks((*planned.motion.robot.remarks, *planned.remarks))
    return DONE


@app.command("view")
def view_command(
    recording: Annotated[Path, typer.Argument(help="Folder of a run, or a recording (.rrd).")],
    web: Annotated[bool, typer.Option("--web", help="In the browser.")] = False,
) -> int:
    """Open a recording in rerun's viewer."""
    path = recording / RECORDING_FILE if recording.is_dir() else recording
    if not path.is_file():
        raise InputError(f"{path}: no such recording; `sot replay CLIP --out DIR` makes one")
    if not web:
        return DONE if viewer.open_in_window(path) else FAILED
    viewer.serve_to_browser(
        path, lambda url: messages.print(f"Serving {url} to the browser until Ctrl-C", soft_wrap=True)
    )
    return DONE


@app.command("report")
def report_command(
    runs: Annotated[
        list[Path], typer.Argument(metavar="DIR...", help="Folders of runs, several are compared; or a library.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", help="File to write; DIR/report.html, or comparison.html beside the runs, by default."
        ),
    ] = None,
) -> int:
    """Make one page (HTML) of a run, of several to compare, or of a library."""
    output.print(f"Written: {write_page(runs, out)}", soft_wrap=True)
    return DONE


@app.command("list")
def list_command(kind: Annotated[Kind, typer.Argument(help="What to list.")]) -> int:
    """List what there is to choose from."""
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    for row in list_rows(kind):
        table.add_row(*(escape(cell) for cell in row))
    output.print(table)
    return DONE


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status; errors are one line each, on stderr."""
    try:
        return int(app(arguments, prog_name="sot", standalone_mode=False) or DONE)
    except InputError as error:
        if isinstance(error, UnknownSkeletonError):
            print(error.mapping, end="")
        return _print_error(BAD_INPUT, str(error))
    except typer.TyperException as error:
        return _print_error(BAD_INPUT, f"{_error_message(error)}; `sot --help` and `sot COMMAND --help` say what goes")
    except (KeyboardInterrupt, typer.Abort):
        return _print_error(INTERRUPTED, "interrupted")
    except Exception as error:
        if os.environ.get(TRACEBACK_VARIABLE):
            raise
        return _print_error(FAILED, f"{type(error).__name__}: {error}; {TRACEBACK_VARIABLE}=1 shows where")


@app.callback(invoke_without_command=True)
def _without_command(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        print(context.get_help())


def _error_message(error: Exception) -> str:
    return str(getattr(error, "format_message", lambda: error)()).rstrip(".")


def _print_error(status: int, message: str) -> int:
    print(f"sot: {' '.join(message.split())}", file=sys.stderr)
    return status
