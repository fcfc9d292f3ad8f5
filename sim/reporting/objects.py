"""Figures of the things that a robot handles: slip in its hands, where they end, and what is felt on them."""

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sim.log import FOOT_FIXED, RunLog
from sim.thing_paths import frame_path, hand_contacts
from sot.robots.system import System

Array = NDArray[np.float64]

TILT_AXIS = 2  # of a thing: its z axis, which stands upright at rest


def object_figures(log: RunLog, system: System) -> dict[str, dict[str, Any]]:
    """By thing: mass, greatest slip in the hands, greatest force of a hand, and where the thing is at the end.

    Args:
        log: Rows in use.
        system: The robot and the things, as they are simulated.
    """
    figures: dict[str, dict[str, Any]] = {}
    for name in log.thing_names:
        position, rotation = frame_path(log, system, name)
        start, end = rotation[0], rotation[-1]
        turned = float(np.degrees(np.linalg.norm(pin.log3(end @ start.T))))
        tilt = float(np.degrees(np.arccos(np.clip(end[:, TILT_AXIS] @ start[:, TILT_AXIS], -1.0, 1.0))))
        hands = list(hand_contacts(log, system, name))
        thing = system.thing(name)
        figures[name] = {
            "mass_kg": thing.mass,
            "slip_max_m": max((slip(log, system, k) for k in hands), default=None),
            "hand_force_max_n": max((float(np.nanmax(log.contact_normal[:, k])) for k in hands), default=None),
            "lifted_max_m": float(position[:, 2].max() - position[0, 2]) if thing.is_free else None,
            "end_m": position[-1].tolist(),
            "end_tilt_deg": tilt if thing.is_free else None,
            "end_angle_deg": None if thing.is_free else turned,
        }
    return figures


def slip(log: RunLog, system: System, contact: int) -> float:
    """Greatest way of a contact's first surface along the second one while it is made with all its load [m]."""
    first, _, second = log.contact_names[contact].partition(" on ")
    surface, other = system.surface(first), system.surface(second)
    held = (log.contact_mode[:, contact] == FOOT_FIXED) & (log.contact_ramp[:, contact] >= 1.0)
    rows = np.flatnonzero(held)
    if not len(rows) or surface.point is None or other.point is None:
        return 0.0
    place, turn = frame_path(log, system, surface.point, rows)
    own = place + turn @ surface.placement.translation
    body, axes = frame_path(log, system, other.point, rows)
    local = np.einsum("tji,tj->ti", axes, own - body) @ other.placement.rotation[:, :2]
    return float(np.linalg.norm(local - local[0], axis=1).max())
