"""Edits of a dance as a text file that a person writes: metres, degrees, and the seconds of the recording."""

import math
from collections.abc import Callable
from pathlib import Path

from scenarios.inputs.stack_file import as_input_error, load_module
from sot.control.pose import AXIS_NAMES
from sot.errors import InputError
from sot.motion.edit import DEFAULT_EASE, Edit
from sot.toml_file import read_toml

EDIT_KEYS = ("point", "joint", "axis", "by", "through", "function", "target", "from", "to", "ease", "limb_only")


def read_edits(path: Path) -> tuple[Edit, ...]:
    """The edits of a file: its [[edit]] tables, in order.

    Raises:
        InputError: no such file, or something in it that makes no sense, with its place.
    """
    content = read_toml(path, "a file of edits")
    entries = content.pop("edit", [])
    if content or not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(f"{path}: holds something else than [[edit]] tables")
    return tuple(_parse_edit(path, f"{path}: edit {number}", entry) for number, entry in enumerate(entries, 1))


def _parse_edit(path: Path, place: str, entry: dict[str, object]) -> Edit:
    unknown = [key for key in entry if key not in EDIT_KEYS]
    if unknown:
        raise InputError(f"{place} has an unknown key '{unknown[0]}': choose some of {', '.join(EDIT_KEYS)}")
    if ("point" in entry) == ("joint" in entry):
        raise InputError(f"{place}: give a point or a joint")
    if "by" in entry and "function" in entry:
        raise InputError(f"{place}: give one of by, through, function and target, not by and function")
    of, axis = str(entry.get("point", entry.get("joint"))), entry.get("axis")
    if axis is not None and (axis not in AXIS_NAMES or "joint" in entry):
        known = f"choose one of {', '.join(AXIS_NAMES)}" if "point" in entry else "a joint has none"
        raise InputError(f"{place}: {of} has no axis '{axis}': {known}")
    unit = 1.0 if axis in ("x", "y", "z") else math.pi / 180.0
    target = entry.get("target")
    if target is not None:
        x, y, z = _checked_numbers(place, "target", target, 3)
    through = entry.get("through")
    if through is not None and not (isinstance(through, list) and through):
        raise InputError(f"{place}: through is a list of way-points [time, value]")
    points = [_checked_numbers(place, "a way-point of through", point, 2) for point in through or ()]
    by: float | Callable[[float], float] | None = None
    if "function" in entry:
        by = _load_function(path, place, entry["function"], unit)
    elif "by" in entry:
        by = unit * _checked_number(place, "by", entry["by"])
    limb_only = entry.get("limb_only", False)
    if not isinstance(limb_only, bool):
        raise InputError(f"{place}: limb_only is true or false, not {limb_only!r}")
    return Edit(
        of=of,
        axis=None if axis is None else str(axis),
        by=by,
        through=[(t, unit * value) for t, value in points] if through is not None else None,
        target=None if target is None else (x, y, z),
        start=_checked_number(place, "from", entry["from"]) if "from" in entry else None,
        end=_checked_number(place, "to", entry["to"]) if "to" in entry else None,
        ease=_checked_number(place, "ease", entry.get("ease", DEFAULT_EASE)),
        limb_only=limb_only,
        source=place,
    )


def _load_function(path: Path, place: str, value: object, unit: float) -> Callable[[float], float]:
    """The function that `function = "FILE.py:NAME"` names; the file lies beside that of the edits."""
    file, colon, name = str(value).rpartition(":")
    if not colon:
        raise InputError(f'{place}: function is "FILE.py:NAME", not "{value}"')
    beside = path.parent / file
    function = getattr(load_module(beside), name, None)
    if not callable(function):
        raise InputError(f"{place}: {beside} defines no function {name}")

    def at(t: float) -> float:
        with as_input_error(beside):
            return unit * float(function(t))

    return at


def _checked_numbers(place: str, what: str, value: object, count: int) -> list[float]:
    if not isinstance(value, list) or len(value) != count:
        raise InputError(f"{place}: {what} is a list of {count} numbers")
    return [_checked_number(place, what, number) for number in value]


def _checked_number(place: str, what: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{place}: {what} has to be a number, not {value!r}")
    return float(value)
