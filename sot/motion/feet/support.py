"""The support polygon over time: where the zero moment point may be, over the feet that carry."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.contacts import Phase, bearing_soles
from sot.polygon import Polygon
from sot.robots.robot import Robot
from sot.robots.size import held_sole, leg_length

Array = NDArray[np.float64]

ZMP_INSET = (0.0666, 0.0416)  # leg lengths along and across the feet, from the edge to the planned ZMP: for feedback
MIN_LOAD_SHARE = 0.12  # of the weight, least load of a standing foot once the load has been transferred
ZMP_INSET_SLIDING = (
    0.0666,
    0.0749,
)  # leg lengths, the same while a foot slides: its load is never steady
FORCE_RAMP_TIME = 0.04  # s after a foot lands, and before it lifts off, in which it is not counted on to carry
LOAD_TRANSFER_TIME = 0.12  # s after and before a change of support in which a foot may carry next to nothing


@dataclass(frozen=True)
class Support:
    """The support from `start` on [s]: the polygon of the soles, and its `inset`, which a plan may use.

    The inset is where the ankles' motors hold the weight, too.
    """

    start: float
    polygon: Polygon
    inset: Polygon


def supports(robot: Robot, phases: Sequence[Phase], inset: tuple[float, float] = ZMP_INSET) -> tuple[Support, ...]:
    """The supports over contact phases: a foot carries from FORCE_RAMP_TIME after landing to as long before lifting.

    inset: along and across the feet, from the edge to where a plan may have the ZMP while no foot slides [leg lengths].
    """
    changes = {phases[0].start, phases[-1].end}
    stretches = []  # foot, its pose, the time in which it carries
    for foot in robot.feet:
        standing = [phase for phase in phases if foot in phase.feet]
        for k, phase in enumerate(standing):
            begins = k == 0 or standing[k - 1].end < phase.start
            ends = k + 1 == len(standing) or phase.end < standing[k + 1].start
            start = phase.start + FORCE_RAMP_TIME * (begins and phase is not phases[0])
            end = phase.end - FORCE_RAMP_TIME * (ends and phase is not phases[-1])
            stretches.append((foot, phase.feet[foot], start, end))
            changes |= {start} if begins else set()
            changes |= {end} if ends else set()
    times = sorted(changes | {phase.start for phase in phases if phase.rising})
    found = []
    for start, end in pairwise(times):
        middle = 0.5 * (start + end)
        feet = {foot: pose for foot, pose, first, last in stretches if first <= middle < last}
        now = next((phase for phase in phases if phase.start <= middle < phase.end), phases[-1])
        rising = tuple(foot for foot in now.rising if foot in feet and len(feet) > 1)
        phase = Phase(start, end, feet, now.sliding, rising=rising)
        early = start if start == times[0] else min(start + LOAD_TRANSFER_TIME, end)
        late = end if end == times[-1] else max(end - LOAD_TRANSFER_TIME, start)
        parts = [(start, end, 0.0)]
        if len(feet) > 1 and early < late:
            parts = [(start, early, 0.0), (early, late, MIN_LOAD_SHARE), (late, end, 0.0)]
        found += [support_over(robot, phase, first, share, inset) for first, last, share in parts if last > first]
    return tuple(found)


def support_over(
    robot: Robot, phase: Phase, start: float, share: float, inset: tuple[float, float] = ZMP_INSET
) -> Support:
    """The support over the feet of a phase from a time on [s], each of which carries at least a share of the weight."""
    polygon = loaded_polygon(bearing_soles(robot.soles, phase), phase, share)
    forward = np.sum([pose.rotation[:2, 0] for pose in phase.feet.values()], axis=0)
    usable = polygon.shrunk(*zmp_inset(robot, phase, inset), heading=float(np.arctan2(forward[1], forward[0])))
    soles = {foot: held_sole(robot, foot) for foot in phase.feet}
    if any(soles[foot] is not robot.sole(foot) for foot in phase.feet):
        held = loaded_polygon(bearing_soles(soles, phase), phase, share)
        both = Polygon(np.vstack([usable.normals, held.normals]), np.concatenate([usable.offsets, held.offsets]))
        usable = both if len(both.vertices) else held
    return Support(start, polygon, usable)


def zmp_inset(robot: Robot, phase: Phase, inset: tuple[float, float] = ZMP_INSET) -> tuple[float, float]:
    """How far along and across the feet a planned ZMP keeps from the edges of the support of a phase [m]."""
    along, across = ZMP_INSET_SLIDING if phase.sliding else inset
    return along * leg_length(robot), across * leg_length(robot)


def loaded_polygon(soles: Mapping[str, Array], phase: Phase, share: float) -> Polygon:
    """The polygon of ZMPs with which every standing foot carries at least a share of the weight.

    A foot that carries next to nothing slides and tilts under the least moment: standing, it should stand.

    soles: foot -> corners (nc, 3) in its frame [m].
    """
    placed = [np.array([pose.act(corner)[:2] for corner in soles[foot]]) for foot, pose in phase.feet.items()]
    most = 1.0 - share * (len(placed) - 1)
    corners = []
    for heavy in range(len(placed)):
        points = np.zeros((1, 2))
        for foot, sole in enumerate(placed):
            part = (most if foot == heavy else share) * sole
            points = (points[:, None] + part[None]).reshape(-1, 2)
        corners.append(points)
    return Polygon.hull(np.vstack(corners))
