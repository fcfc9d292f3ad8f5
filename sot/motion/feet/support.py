"""Where the zero moment point may be, over time: the polygons of the feet that carry."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sot.motion.feet.contacts import Phase
from sot.polygon import Polygon
from sot.robots.robot import Robot

INSET = (0.04, 0.025)  # m along and across the feet, from the edge to the planned ZMP: what the closed loop may use
SHARE = 0.12  # of the weight, least load of every foot that stands for good
BESIDE_SLIDE = (0.04, 0.045)  # m, the same where a foot slides: its load, far from the other, is never quite steady
RAMP = 0.04  # s after a foot lands, and before it lifts off, in which it does not carry
SETTLING = 0.12  # s from a change of the feet that carry, in which one of them may carry next to nothing


@dataclass(frozen=True)
class Support:
    """What carries from `start` on [s]: the polygon of the soles, and the `inset` of it that a plan may use."""

    start: float
    polygon: Polygon
    inset: Polygon


def supports(robot: Robot, phases: Sequence[Phase]) -> tuple[Support, ...]:
    """The supports of contact phases: a foot carries from RAMP after it lands to RAMP before it lifts off."""
    changes = {phases[0].start, phases[-1].end}
    stretches = []  # foot, its pose, the time in which it carries
    for foot in robot.feet:
        standing = [phase for phase in phases if foot in phase.feet]
        for k, phase in enumerate(standing):
            begins = k == 0 or standing[k - 1].end < phase.start
            ends = k + 1 == len(standing) or phase.end < standing[k + 1].start
            start = phase.start + RAMP * (begins and phase is not phases[0])
            end = phase.end - RAMP * (ends and phase is not phases[-1])
            stretches.append((foot, phase.feet[foot], start, end))
            changes |= {start} if begins else set()
            changes |= {end} if ends else set()
    times = sorted(changes)
    found = []
    for start, end in pairwise(times):
        middle = 0.5 * (start + end)
        feet = {foot: pose for foot, pose, first, last in stretches if first <= middle < last}
        sliding = next((phase.sliding for phase in phases if phase.start <= middle < phase.end), ())
        phase = Phase(start, end, feet, sliding)
        early = start if start == times[0] else min(start + SETTLING, end)
        late = end if end == times[-1] else max(end - SETTLING, start)
        parts = [(start, end, 0.0)]
        if len(feet) > 1 and early < late:
            parts = [(start, early, 0.0), (early, late, SHARE), (late, end, 0.0)]
        found += [_support(robot, phase, first, share) for first, last, share in parts if last > first]
    return tuple(found)


def _support(robot: Robot, phase: Phase, start: float, share: float) -> Support:
    polygon = loaded(robot, phase, share)
    forward = np.sum([pose.rotation[:2, 0] for pose in phase.feet.values()], axis=0)
    inset = BESIDE_SLIDE if phase.sliding else INSET
    return Support(start, polygon, polygon.shrunk(*inset, heading=float(np.arctan2(forward[1], forward[0]))))


def loaded(robot: Robot, phase: Phase, share: float) -> Polygon:
    """Where the ZMP may be if every foot that stands carries at least a share of the weight.

    A foot that carries next to nothing slides and tilts under the least moment: standing, it should stand.
    """
    soles = [np.array([pose.act(corner)[:2] for corner in robot.sole(foot)]) for foot, pose in phase.feet.items()]
    most = 1.0 - share * (len(soles) - 1)
    corners = []
    for heavy in range(len(soles)):
        points = np.zeros((1, 2))
        for foot, sole in enumerate(soles):
            part = (most if foot == heavy else share) * sole
            points = (points[:, None] + part[None]).reshape(-1, 2)
        corners.append(points)
    return Polygon.hull(np.vstack(corners))
