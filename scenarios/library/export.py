"""`sot export`: the simulated motion of a run in the files that trackers, retargeters and data sets read."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from scenarios.replay import SIMULATED_FILE, check_writable
from scenarios.terminal import DONE, output
from sim.recording.video import write_video
from sot.errors import InputError
from sot.exchange.licence_card import licence_card
from sot.exchange.registry import Format, find_format
from sot.exchange.robot_motion import RobotMotion
from sot.exchange.simulated_motion import SimulatedMotion
from sot.robots.robot import Robot
from sot.whole_file import atomic_folder, atomic_write

EXPORTS = "exports"
CARD_ENDING = ".card.md"
MIN_RATE_HZ, MAX_RATE_HZ = 1.0, 2000.0


VIDEO = "mp4"


def parse_formats(text: str) -> tuple[Format | None, ...]:
    """Formats that a list like "unitree-csv,gmr-pickle" names, each once; None is the video, "mp4".

    Raises:
        InputError: a name that is none, or of a format that is not written.
    """
    names = dict.fromkeys(name.strip() for name in text.split(","))
    formats = [None if name == VIDEO else find_format(name) for name in names]
    for one in formats:
        if one is not None and one.write is None:
            raise InputError(f"{one.name} is not exported: {one.words}")
    return tuple(formats)


def export_run(
    run: Path,
    formats: Sequence[Format | None],
    out: Path | None = None,
    rate: float | None = None,
    robot: str | None = None,
) -> list[Path]:
    """Write the simulated motion of a run in some formats, each with a licence card beside it.

    Args:
        run: Folder of the run.
        formats: To write; None for a video.
        out: Folder for them; `exports` in the run's own by default. Each format has a folder of its own there.
        rate: Frames per second [Hz]; those customary for each format by default.
        robot: Name or file of the robot; the run's by default.

    Returns:
        The files and folders written, without the cards.

    Raises:
        InputError: no run, or a format that cannot hold it. What was written before is whole.
    """
    path = run / SIMULATED_FILE
    if not path.is_file():
        raise InputError(f"{run}: no run of `sot replay` or of an earlier version, it has no {SIMULATED_FILE}")
    simulated = SimulatedMotion.load(path)
    model = Robot.load(robot or simulated.facts.get("robot", ""))
    motion = simulated.motion(model, _file_name(simulated, run))
    folder = out or run / EXPORTS
    check_writable(folder)
    written = []
    for one in formats:
        if one is not None:
            written.append(_write(motion.resampled(rate or one.rate), one, folder / one.name))
            continue
        path = folder / VIDEO / f"{motion.name}.{VIDEO}"
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as place:
            write_video(simulated, model, place)
        written.append(path)
    return written


def _file_name(simulated: SimulatedMotion, run: Path) -> str:
    """The clip's name, without what a file's name may not have."""
    name = simulated.facts.get("clip") or run.resolve().name
    return "".join(c if c.isalnum() or c in "-_. " else "_" for c in name).strip(". ") or "motion"


def _write(motion: RobotMotion, one: Format, folder: Path) -> Path:
    assert one.write is not None
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{motion.name}{one.ending}"
    with atomic_write(path) if one.ending else atomic_folder(path) as place:
        one.write(motion, place)
    with atomic_write(folder / f"{motion.name}{CARD_ENDING}") as place:
        place.write_text(licence_card(motion, one.name, one.words, one.isaac), encoding="utf-8")
    return path


def export_command(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders of runs.")],
    to: Annotated[str, typer.Option("--to", help="Names of `sot list formats`, or mp4, separated by commas.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder for the files; RUN/exports by default.")
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            "--fps",
            help="Frames per second; by default those that are customary for the format.",
            min=MIN_RATE_HZ,
            max=MAX_RATE_HZ,
        ),
    ] = None,
    robot: Annotated[
        str | None, typer.Option("--robot", help="The run's robot, if it is none of `sot list robots`: its file.")
    ] = None,
) -> int:
    """Write what a run's robot did as motion files that trackers and viewers read, a licence card beside each."""
    formats = parse_formats(to)
    for run in runs:
        own = out / run.resolve().name if out is not None and len(runs) > 1 else out
        for path in export_run(run, formats, own, rate, robot):
            output.print(f"Written: {path}", soft_wrap=True)
    return DONE
