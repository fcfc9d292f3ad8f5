"""A rerun recording whose messages are ordered so that it opens fast."""

from collections.abc import Sequence

import numpy as np
import rerun as rr

TIMELINE = "time"
Color = tuple[int, ...]  # rgb or rgba, 0..255
Entity = str | Sequence[str]  # a path, or its parts where they may hold any character
COLORS: dict[str, Color] = {
    "measured": (255, 140, 40),
    "controller": (90, 170, 255),
    "planned": (110, 210, 110),
    "limit": (215, 60, 60),
    "com": (250, 220, 60),
    "com_planned": (150, 135, 60),
    "dcm": (190, 130, 255),
    "dcm_planned": (120, 90, 160),
    "foothold": (150, 155, 165),
    "fixed": (60, 190, 180),
    "sliding": (255, 190, 70),
    "rolling": (90, 150, 230),
    "off": (130, 130, 135),
    "human": (235, 200, 120),
    "ghost": (120, 165, 130, 150),
    "floor": (58, 62, 70, 110),
    "grid": (80, 85, 95),
    "text": (225, 225, 225),
}
SERIES_COLORS: tuple[Color, ...] = (
    *((235, 90, 90), (80, 180, 95), (80, 140, 245), (225, 165, 40)),
    *((175, 105, 225), (60, 185, 195), (150, 150, 150)),
)


class Columns:
    """A rerun recording that takes arrays over time.

    A viewer takes in a few messages a picture, in the order of the file: what holds for the whole recording goes first,
    then the columns in the order in which they came, each as one message.
    """

    def __init__(self, stream: rr.RecordingStream) -> None:
        self._stream = stream
        self._unsent: list[tuple[str, np.ndarray, list[rr.ComponentColumn]]] = []

    def static(self, entity: Entity, *archetypes: rr.AsComponents) -> None:
        """Log archetypes that hold for the whole recording."""
        self._stream.log(entity_path(entity), *archetypes, static=True)

    def over_time(self, entity: Entity, times: np.ndarray, *columns: rr.ComponentColumnList) -> None:
        """Queue component columns with one row per time [s]."""
        self._unsent.append((entity_path(entity), times, [column for part in columns for column in part]))

    def points(self, entity: Entity, times: np.ndarray, positions: np.ndarray, color: str, radius: float) -> None:
        """Queue a moving point (T, 3), which is hidden where it is nan."""
        seen = np.isfinite(positions).all(axis=1)
        self.static(entity, rr.Points3D.from_fields(colors=[COLORS[color]], radii=[radius]))
        columns = rr.Points3D.columns(positions=positions[seen].astype(np.float32))
        self.over_time(entity, times, columns.partition(seen.astype(int)))

    def send(self) -> None:
        """Write all queued columns."""
        self._stream.flush()
        for entity, times, columns in self._unsent:
            self._stream.send_columns(entity, [rr.TimeColumn(TIMELINE, duration=times)], columns)
        self._unsent.clear()
        self._stream.flush()


def css_color(color: Color) -> str:
    """A colour in CSS notation, without its opacity."""
    return "#{:02x}{:02x}{:02x}".format(*color[:3])


def entity_path(entity: Entity) -> str:
    """The path of an entity, its parts escaped."""
    return entity if isinstance(entity, str) else rr.new_entity_path(list(entity))
