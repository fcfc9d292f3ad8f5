"""Curves and states over time: the columns that hold them, and the views that show them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from sim.recording.columns import COLORS, SERIES_COLORS, Color, Columns, Entity, entity_path

CURVE_WIDTH = 1.5  # in points


@dataclass(frozen=True)
class Curves:
    """Curves that share their times.

    Attributes:
        name: of the entity that holds them, below their plot's.
        times: (T,) [s].
        values: (T, n), or (T,) for a single curve; nan where there is nothing to show.
        names: one a curve.
        colors: one a curve, or its name in `COLORS`; without, each gets a colour of its own.
    """

    name: str
    times: np.ndarray
    values: np.ndarray
    names: Sequence[str]
    colors: Sequence[str | Color] = ()

    def send(self, columns: Columns, entity: Entity) -> None:
        """Send them as an entity."""
        shades = [COLORS[color] if isinstance(color, str) else color for color in self.colors]
        shades = shades or [SERIES_COLORS[k % len(SERIES_COLORS)] for k in range(len(self.names))]
        lines = rr.SeriesLines(names=list(self.names), colors=shades, widths=[CURVE_WIDTH] * len(self.names))
        columns.static(entity, lines)
        # Seven digits are enough to look at, and the zeros behind them make the file smaller.
        rounded = self.values.astype(np.float32).astype(np.float64)
        scalars = rr.Scalars.columns(scalars=rounded.ravel())
        columns.over_time(entity, self.times, scalars.partition([len(self.names)] * len(self.times)))


@dataclass(frozen=True)
class Plot:
    """Curves in one view.

    Attributes:
        title: with the unit.
        entity: above its curves.
        curves: drawn in this order.
        range: of the vertical axis; as the curves need unless given.
    """

    title: str
    entity: Sequence[str]
    curves: tuple[Curves, ...]
    range: tuple[float, float] | None = None

    def view(self) -> rrb.View:
        """What shows it."""
        axis = rrb.ScalarAxis(range=self.range) if self.range else None
        return rrb.TimeSeriesView(origin=entity_path(self.entity), name=self.title, axis_y=axis)

    def send(self, columns: Columns) -> None:
        """Send the columns behind it."""
        for curves in self.curves:
            curves.send(columns, (*self.entity, curves.name))


@dataclass(frozen=True)
class States:
    """States of several things over time.

    Attributes:
        title: of the view.
        entity: above its lanes.
        times: (T,) [s].
        lanes: thing -> states (T,), by their index in `names`.
        names: of the states.
        colors: of the states.
    """

    title: str
    entity: Sequence[str]
    times: np.ndarray
    lanes: Mapping[str, np.ndarray]
    names: Sequence[str]
    colors: Sequence[Color]

    def view(self) -> rrb.View:
        """What shows it."""
        return rrb.StateTimelineView(origin=entity_path(self.entity), name=self.title)

    def send(self, columns: Columns) -> None:
        """Send the columns behind it, a row a change."""
        colors = np.array([int.from_bytes(bytes((*color[:3], 255))) for color in self.colors], dtype=np.uint32)
        for lane, values in self.lanes.items():
            entity = (*self.entity, lane)
            columns.static(entity, rr.StateConfiguration(values=list(self.names), colors=colors))
            changes = np.flatnonzero(np.diff(values, prepend=-1))
            named = rr.StateChange.columns(state=[self.names[value] for value in values[changes]])
            columns.over_time(entity, self.times[changes], named)
