"""`sot robot new`: a guessed robot file and its picture, written beside each other."""

from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from scenarios.robots.drawing import draw
from sot.errors import InputError
from sot.robots.guess import Guess, Sureness, guess, robot_file
from sot.whole_file import atomic_write

STYLES = {Sureness.SURE: "green", Sureness.LIKELY: "yellow", Sureness.UNSURE: "bold red"}


@dataclass(frozen=True)
class Written:
    """A guess, and the files it was written to."""

    found: Guess
    file: Path
    picture: Path


def new(model: Path, file: Path | None) -> Written:
    """Guess a robot file and write it, with a picture (`.svg`) beside it; nothing is ever overwritten.

    Args:
        model: MJCF or URDF.
        file: to write (`.toml`); MODEL.toml in the current folder unless given.

    Raises:
        InputError: no such model, it is no humanoid, or a file is there already.
    """
    file = file or Path(f"{model.stem}.toml")
    picture = file.with_suffix(".svg")
    if file.suffix != ".toml":
        raise InputError(f"{file}: a robot file ends in .toml")
    if not model.is_file():
        raise InputError(f"{model}: no such model file (.xml, .urdf)")
    for path in (file, picture):
        if path.exists():
            raise InputError(f"{path}: is there already; choose another name with -o, nothing is overwritten")
    if not file.absolute().parent.is_dir():
        raise InputError(f"{file.parent}: no such folder")
    found = guess(model)
    try:
        with atomic_write(file) as place:
            place.write_text(robot_file(found, file.absolute().parent), encoding="utf-8")
        draw(found, picture)
    except OSError as error:
        raise InputError(f"{file}: cannot be written ({error.strerror})") from error
    return Written(found, file, picture)


def print_evidence(found: Guess, console: Console) -> None:
    """Print what was guessed, why, and how sure it is."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for head in ("", "part", "guessed", "because"):
        table.add_column(head, overflow="fold")
    for each in found.evidence:
        sure = f"[{STYLES[each.sureness]}]{each.sureness}[/]"
        table.add_row(sure, *(escape(text) for text in (each.what, each.found, each.why)))
    console.print(table)
