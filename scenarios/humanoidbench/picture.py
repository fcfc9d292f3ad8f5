"""The ways of robot and thing seen from above, and how far the thing is from its destination, or has turned."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from scenarios.replay import Dance
from sim.reporting.chart import Curve, Panel, write_panels

PICTURE_FILE = "way.svg"
RATE = 25.0  # Hz
WAIST, THING, GOAL = "#1560d4", "#d9682b", "#2b9a4a"


def draw(path: Path, danced: Dance, destination: Sequence[float] | None, title: str) -> None:
    """Draw the ways of a run.

    Args:
        path: File to write.
        danced: The run.
        destination: Where a free thing is to be (2,) or (3,) [m]; none where joints of it are to turn.
        title: Of the picture.
    """
    log = danced.run.log.trimmed()
    rows = log.rows_at(RATE)
    time, base, thing = log.time[rows], log.q[rows, :2], log.thing_q[rows]
    curves = [Curve(base[:, 0], base[:, 1], WAIST, "waist")]
    if destination is None:
        told = [
            Curve(time, thing[:, k], color, name) for k, (color, name) in enumerate(((THING, "hinge"), (GOAL, "lever")))
        ]
        other = Panel("angles of the door", "s", "rad", told)
    else:
        goal = np.array(destination[:2])
        off = np.linalg.norm(thing[:, :2] - goal, axis=1)
        cross = 0.04 * np.array([[-1, -1], [1, 1], [np.nan, np.nan], [-1, 1], [1, -1]])
        curves.append(Curve(thing[:, 0], thing[:, 1], THING, "thing"))
        curves.append(Curve(goal[0] + cross[:, 0], goal[1] + cross[:, 1], GOAL, "destination"))
        other = Panel("distance from the destination", "s", "m", [Curve(time, off, THING)])
    write_panels(path, title, [Panel("seen from above", "x, m", "y, m", curves, equal=True), other], 2)
