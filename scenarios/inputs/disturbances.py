"""Pushes and mismatches as one writes them on a command line: words like ``t=5 force=80,0,0``; series of pushes."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from sim.mismatch import Mismatch
from sim.push import Push
from sot.errors import InputError

ParserByName = Mapping[str, Callable[[str], Any]]

TURN_BETWEEN_PUSHES = 2.2
"""Angle between a push of a series and the next, which no small number of them closes to a circle [rad]."""


def spaced_pushes(begin: float, end: float, count: int, impulse: float) -> Iterator[Push]:
    """Horizontal pushes of an impulse [N s] at even times from one to another [s], each from elsewhere."""
    for number, t in enumerate(np.linspace(begin, end, count).tolist()):
        yield Push.horizontal(t, impulse, TURN_BETWEEN_PUSHES * number)


def parse_push(text: str) -> Push:
    """A push from "t=5 force=80,0,0", with "duration=0.1" and "body=chest" unless given [s, N].

    Raises:
        InputError: anything else.
    """
    words = _parse_assignments("--push", text, {"t": float, "force": _parse_vector, "duration": float, "body": str})
    if missing := {"t", "force"} - set(words):
        raise InputError(
            f'--push "{text}": {min(missing)} is missing, as in "t=5 force=80,0,0 duration=0.1 body=chest"'
        )
    return Push(**words)


def parse_mismatch(text: str) -> Mismatch:
    """A mismatch from any of "mass=1.1 damping=2 gear_friction=0.02 delay=0.002 noise=0.05 friction=0.5 seed=1".

    Raises:
        InputError: anything else.
    """
    numbers: ParserByName = dict.fromkeys(("mass", "damping", "gear_friction", "delay", "noise", "friction"), float)
    return Mismatch(**_parse_assignments("--mismatch", text, {**numbers, "seed": int}))


def _parse_assignments(option: str, text: str, kinds: ParserByName) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for word in text.split():
        name, equals, value = word.partition("=")
        if not equals or name not in kinds or name in found:
            raise InputError(
                f"{option} \"{text}\": '{word}' does not go; give each of {', '.join(kinds)} as name=value"
            )
        try:
            found[name] = kinds[name](value)
        except ValueError:
            raise InputError(f"{option} \"{text}\": {name} is no {_PARSER_NOUNS[kinds[name]]}: '{value}'") from None
    return found


def _parse_vector(text: str) -> tuple[float, ...]:
    x, y, z = map(float, text.split(","))
    return x, y, z


_PARSER_NOUNS: dict[Callable[[str], Any], str] = {float: "number", int: "whole number", _parse_vector: "force x,y,z"}
