"""The table of surfaces in the text file of a robot or of a thing."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sot.errors import InputError
from sot.robots.surface import Surface
from sot.toml_file import is_number, nearest

KEYS = ("point", "corners", "friction")
MAX_FRICTION = 1.0
"""Largest friction coefficient that a surface may have: rubber's."""


def read_surfaces(
    path: Path, table: Any, points: Sequence[str], default_point: str | None = None
) -> dict[str, Surface]:
    """Surfaces by name, each from a table with `corners`, `friction` and the `point` in whose frame they are.

    Args:
        path: of the text file, for messages.
        table: what the file says of `surfaces`.
        points: what surfaces may be fixed to.
        default_point: what they are fixed to unless they say so.

    Raises:
        InputError: a key is unknown or missing, a point does not exist, or the corners make no surface.
    """
    if not isinstance(table, dict):
        raise InputError(f"{path}: 'surfaces' must be a table")
    surfaces = {}
    for name, content in table.items():
        key = f"surfaces.{name}"
        if not isinstance(content, dict):
            raise InputError(f"{path}: '{key}' must be a table with {', '.join(KEYS)}")
        for unknown in set(content) - set(KEYS):
            raise InputError(f"{path}: a surface has no '{unknown}'{nearest(unknown, KEYS)}: it has {', '.join(KEYS)}")
        point, friction = content.get("point", default_point), content.get("friction", 0.5)
        if point not in points:
            raise InputError(f"{path}: '{key}.point' names '{point}', which is no point{nearest(point, points)}")
        if not is_number(friction) or not 0.0 < friction <= MAX_FRICTION:
            raise InputError(f"{path}: '{key}.friction' must be above 0 and at most {MAX_FRICTION:g}, not {friction}")
        try:
            surfaces[name] = Surface.of_corners(name, content.get("corners", ()), point, float(friction))
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
    return surfaces
