"""Kim & Oh's Figures 16 and 17 of our own robots: the zero-moment point after a push, with and without damping."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.kimoh2013.damping.push_runs import Sway
from sim.reporting.chart import Curve, Panel, write_panels

COLORS = ("#999", "#2a9d5c", "#7a4fd9", "#2b6fd9", "#d9762b")
BEFORE_S, SHOWN_S = 0.5, 5.0


def draw_sways(path: Path, label: str, sways: Mapping[str, Mapping[str, Sway]]) -> None:
    """A panel a case, a curve a controller."""
    panels = []
    for name, curves in sways.items():
        drawn = []
        for (words, sway), color in zip(curves.items(), COLORS, strict=False):
            shown = (sway.time > -BEFORE_S) & (sway.time < SHOWN_S)
            drawn.append(Curve(sway.time[shown], 1e3 * sway.zmp[shown], color, words))
        largest = max(np.nanmax(np.abs(curve.y), initial=0.0) for curve in drawn[:-1] or drawn)
        drawn = [
            Curve(curve.x, np.where(np.abs(curve.y) < 1.5 * largest, curve.y, np.nan), curve.color, curve.label)
            for curve in drawn
        ]
        panels.append(Panel(name, "s after the push", "zero-moment point [mm]", drawn))
    write_panels(path, f"{label}, pushed (Kim & Oh Figures 16 and 17)", panels, 2, (560.0, 260.0))


def print_pushes(cases: Mapping[str, Mapping[str, Mapping[str, Any]]], console: Console) -> None:
    """Print a row a case and controller."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in ("case", "controller", "fell", "peak\nmm", "settled\ns", "swing back\n%", "zeta, asked\n"):
        table.add_column(words, justify="left" if words in ("case", "controller") else "right")
    for words in ("measured\n", "margin\n", "survived once, five times\nN s"):
        table.add_column(words, justify="right")
    for case, controllers in cases.items():
        for name, found in controllers.items():
            repeated = found.get("survived_repeated_n_s", {})
            survived = ", ".join(
                f"{words} {value:.0f}, {repeated[words]:.0f}" for words, value in found.get("survived_n_s", {}).items()
            )
            stands = found["peak_m"] is not None
            table.add_row(
                case,
                name,
                f"{found['fell']} of {found['runs']}",
                f"{1e3 * found['peak_m']:.0f}" if stands else "-",
                "{:.2f}-{:.2f}".format(*found["settling_s"]) if stands else "-",
                f"{100.0 * found['swing_back']:.0f}" if stands else "-",
                "-" if found["asked"] is None else f"{found['asked']:g}",
                "{:.2f} {:.2f} {:.2f}".format(*found["damping_ratio"]) if stands else "-",
                "-" if found["margin"] is None else f"{found['margin']:.2f}",
                survived or "-",
            )
    console.print(table)
