"""The contacts of a demonstration as a text file, to look at, to edit and to give back."""

import math
from pathlib import Path
from typing import Any

from sot.errors import InputError
from sot.motion.objects.events import CHANGES, ContactEvent, ContactPlan, SurfaceName, SurfacePair
from sot.toml_file import read_toml
from sot.whole_file import atomic_write

HEAD = """\
# Which surfaces touch: those at the start, and the events that change it, in seconds of the clip and in order of time.
# A surface is entity/surface; the entities are the robot, the things by their names, and the world.
# Change, remove or add entries, and give the file back with --events.
"""


def write(path: Path, plan: ContactPlan) -> None:
    """Write contacts and events to a file (`.toml`), which appears once it is complete."""
    blocks = [f"\n[[contact]]\nbetween = {_pair_text(pair)}\n" for pair in plan.initial]
    blocks += [
        f'\n[[event]]\ntime = {event.time:.2f}\nchange = "{event.change}"\nbetween = {_pair_text(event.pair)}\n'
        for event in plan.events
    ]
    with atomic_write(path) as place:
        place.write_text(HEAD + "".join(blocks), encoding="utf-8")


def read(path: Path) -> ContactPlan:
    """The contacts of a file that `write` wrote, as someone may have edited it.

    Raises:
        InputError: Not such a file, or an entry that makes no sense or contradicts the ones before.
    """
    content = read_toml(path, "a file of contact events")
    contacts, events = content.pop("contact", []), content.pop("event", [])
    for entries in (contacts, events):
        if content or not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            raise InputError(f"{path}: holds something else than [[contact]] and [[event]] tables")
    initial = [_contact(f"{path}: contact {number}", entry) for number, entry in enumerate(contacts, 1)]
    listed = [_event(f"{path}: event {number}", entry) for number, entry in enumerate(events, 1)]
    try:
        return ContactPlan(tuple(initial), tuple(listed))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _pair_text(pair: SurfacePair) -> str:
    return f'["{pair.first}", "{pair.second}"]'


def _contact(where: str, entry: dict[str, Any]) -> SurfacePair:
    if set(entry) != {"between"}:
        raise InputError(f"{where} needs between, and nothing else")
    return _pair(where, entry["between"])


def _event(where: str, entry: dict[str, Any]) -> ContactEvent:
    if set(entry) != {"time", "change", "between"}:
        raise InputError(f"{where} needs time, change and between, and nothing else")
    time, change = entry["time"], entry["change"]
    if not isinstance(time, int | float) or isinstance(time, bool) or not (math.isfinite(time) and time >= 0.0):
        raise InputError(f"{where}: time must be seconds of the clip, not {time!r}")
    if change not in CHANGES:
        raise InputError(f"{where}: change is {change!r}, choose {' or '.join(CHANGES)}")
    return ContactEvent(float(time), change, _pair(where, entry["between"]))


def _pair(where: str, names: Any) -> SurfacePair:
    if not isinstance(names, list) or len(names) != 2 or not all(isinstance(name, str) for name in names):
        raise InputError(f'{where}: between must be two surfaces, as ["robot/left_palm", "box/left"]')
    try:
        return SurfacePair.of(*(SurfaceName.parse(name) for name in names))
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
