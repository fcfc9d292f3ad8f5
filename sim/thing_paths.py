"""Where points of the robot and of things were in a run, and which logged contacts are a hand's with a thing."""

from collections.abc import Iterator

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sim.log import RunLog
from sot.robots.system import System

Array = NDArray[np.float64]
Rows = NDArray[np.int_]


def hand_contacts(log: RunLog, system: System, thing: str) -> Iterator[int]:
    """Columns of the logged contacts of a surface of the robot with a thing."""
    for k, name in enumerate(log.contact_names):
        first, _, second = name.partition(" on ")
        if second.split("/")[0] == thing and "/" not in first:
            yield k


def frame_path(log: RunLog, system: System, point: str, rows: Rows | None = None) -> tuple[Array, Array]:
    """Positions (T, 3) [m] and rotations (T, 3, 3) of a point of the robot or of a thing, at some rows of the log."""
    chosen = np.arange(log.ticks) if rows is None else rows
    model, data, frame = system.model, system.model.createData(), system.point(point)
    position, rotation = np.empty((len(chosen), 3)), np.empty((len(chosen), 3, 3))
    for k, row in enumerate(chosen.tolist()):
        pin.forwardKinematics(model, data, np.concatenate([log.q[row], log.thing_q[row]]))
        place = pin.updateFramePlacement(model, data, frame)
        position[k], rotation[k] = place.translation, place.rotation
    return position, rotation
