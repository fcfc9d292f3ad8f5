"""Contact phases: which foot stands where, and when; and the support polygon of a phase."""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.polygon import Polygon
from sot.robots.robot import Robot
from sot.robots.soles import front
from sot.robots.surface import Surface

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Phase:
    """A contact phase: a stretch of time in which the same feet stand at the same places.

    Attributes:
        start, end: in motion time [s].
        feet: standing foot -> pose of its frame, the sole flat on the floor.
        sliding: feet that slide on the floor.
        surfaces: standing foot -> surface of the world under it; the floor where nothing is said.
        rising: feet whose heels rise: they stand on the front edges of their soles, where they were flat.
    """

    start: float
    end: float
    feet: Mapping[str, pin.SE3]
    sliding: tuple[str, ...] = ()
    surfaces: Mapping[str, Surface] = field(default_factory=dict)
    rising: tuple[str, ...] = ()


def planted_phases(robot: Robot, duration: float) -> tuple[Phase, ...]:
    """The one contact phase of a motion whose feet stay where the rest posture puts them."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    feet = {foot: data.oMf[robot.point(foot)].copy() for foot in robot.feet}
    return (Phase(0.0, duration, feet),)


def support_polygon(robot: Robot, phase: Phase) -> Polygon:
    """The convex hull of what the feet of a phase stand on."""
    soles = bearing_soles(robot.soles, phase)
    return Polygon.hull(
        np.vstack([[pose.act(corner)[:2] for corner in soles[foot]] for foot, pose in phase.feet.items()])
    )


def bearing_soles(soles: Mapping[str, Array], phase: Phase) -> Mapping[str, Array]:
    """The corners (nc, 3) of soles on which feet stand in a phase: of one whose heel rises, those of its front edge."""
    if not phase.rising:
        return soles
    return {**soles, **{foot: soles[foot][front(soles[foot])] for foot in phase.rising}}


def phase_indices(phases: Sequence[Phase], times: np.ndarray) -> np.ndarray:
    """Index (T,) of the phase at each time (T,) [s]."""
    return np.clip(np.searchsorted([phase.start for phase in phases], times, side="right") - 1, 0, len(phases) - 1)


def phase_at(phases: Sequence[Phase], t: float) -> Phase:
    """The phase at a time [s]; the first before it begins, the last after it has ended."""
    return phases[max(bisect_right(phases, t, key=lambda phase: phase.start) - 1, 0)]
