"""Curves of a fetched bag: how far the robot leans, what hand and hook bear, and how high the bag is."""

from pathlib import Path

import numpy as np

from scenarios.otani2017.bag.figures import HOOK, PALM
from scenarios.otani2017.bag.scene import BagPlan
from sim.log import RunLog
from sim.reporting.chart import Curve, Panel, write_panels

PICTURE_FILE = "curves.svg"
RATE = 25.0  # Hz
MM_PER_M = 1e3
MEASURED, COMMANDED = "#1560d4", "#d9682b"


def draw(path: Path, log: RunLog, plan: BagPlan, title: str) -> None:
    """Draw the curves of a run."""
    rows = log.rows_at(RATE)
    time, height = log.time[rows], MM_PER_M * (log.thing_q[rows, 2] - log.thing_q[0, 2])
    panels = [
        _panel("centre of mass beyond the sole", "mm", time, [MM_PER_M * (log.com[rows, 0] - plan.sole_edge)]),
        *(
            _panel(
                f"{words}, normal force", "N", time, [column[rows, log.contact_names.index(name)] for column in both]
            )
            for words, name, both in (
                ("palm", PALM, (log.contact_normal, log.contact_commanded)),
                ("hook", HOOK, (log.contact_normal, log.contact_commanded)),
            )
        ),
        _panel("bag, height above where it stood", "mm", time, [height]),
    ]
    write_panels(path, title, panels, 2)


def _panel(title: str, unit: str, time: np.ndarray, values: list[np.ndarray]) -> Panel:
    words = zip((MEASURED, COMMANDED), ("measured", "commanded"), strict=True)
    curves = [Curve(time, value, color, name) for value, (color, name) in zip(values, words, strict=False)]
    return Panel(title, "s", unit, curves)
