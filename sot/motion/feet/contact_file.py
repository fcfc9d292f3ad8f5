"""The steps of a dance as a text file, to look at, to edit and to give back."""

import math
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from sot.errors import InputError
from sot.motion.feet.footwork import Step
from sot.robots.robot import FEET
from sot.toml_file import read_toml
from sot.whole_file import atomic_write

HEAD = """\
# When each foot is off the floor, in seconds of the clip. Between its steps a foot stands, where the dancer's does.
# Change, remove or add steps, and give the file back with --contacts. Steps that cannot be made at these times, one
# foot after the other, are moved by the least.
"""


def write(path: Path, steps: Sequence[Step]) -> None:
    """Write steps, in the clip's time, to a file (`.toml`), which appears once it is complete."""
    blocks = [
        f'\n[[step]]\nfoot = "{step.foot.removesuffix("_foot")}"\nlift = {step.lift:.2f}\nland = {step.land:.2f}\n'
        for step in steps
    ]
    with atomic_write(path) as place:
        place.write_text(HEAD + "".join(blocks), encoding="utf-8")


def read(path: Path) -> tuple[Step, ...]:
    """Steps of a file that `write` wrote, as someone may have edited it.

    Raises:
        InputError: not such a file, or a step that makes no sense.
    """
    content = read_toml(path, "a file of contacts")
    entries = content.pop("step", [])
    if content or not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(
            f"{path}: holds something else than [[step]] tables: see what `sot retarget -o FILE.toml` writes"
        )
    steps = [_step(path, number, entry) for number, entry in enumerate(entries, 1)]
    for foot in FEET:
        own = sorted((step for step in steps if step.foot == foot), key=lambda step: step.lift)
        for before, after in pairwise(own):
            if after.lift <= before.land:
                raise InputError(
                    f"{path}: the {foot} is lifted at {after.lift:g} s, before it lands at {before.land:g} s"
                )
    return tuple(sorted(steps, key=lambda step: step.lift + step.land))


def _step(path: Path, number: int, entry: dict[str, object]) -> Step:
    where = f"{path}: step {number}"
    if set(entry) != {"foot", "lift", "land"}:
        raise InputError(f"{where} needs foot, lift and land, and nothing else")
    foot, lift, land = f"{entry['foot']}_foot", entry["lift"], entry["land"]
    if foot not in FEET:
        raise InputError(f"{where}: foot is '{entry['foot']}', choose left or right")
    if not isinstance(lift, int | float) or not isinstance(land, int | float) or isinstance(lift, bool):
        raise InputError(f"{where}: lift and land must be times in the clip [s]")
    if not (math.isfinite(lift) and math.isfinite(land) and lift < land):
        raise InputError(f"{where}: the foot has to land, at {land:g} s, after it is lifted, at {lift:g} s")
    return Step(foot, float(lift), float(land))
