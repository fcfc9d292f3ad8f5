"""The support that a run's planned contacts give, tick by tick."""

from collections.abc import Iterator
from itertools import product

import numpy as np

from sim.log import FOOT_FIXED, FOOT_ROLLING, RunLog
from sot.motion.feet.contacts import Phase, phase_indices, support_polygon
from sot.motion.trajectory import Motion
from sot.polygon import Polygon


def planned_support(log: RunLog, motion: Motion) -> Iterator[tuple[np.ndarray, Polygon]]:
    """Rows of a log that share a support polygon, with that polygon; rows without support are left out.

    A foot counts where the plan puts it, while its contact is fixed and its force ramp is over.
    """
    feet = motion.robot.feet
    rolls = log.foot_mode == FOOT_ROLLING
    carries = (rolls | (log.foot_mode == FOOT_FIXED)) & (log.foot_ramp >= 1.0)
    flats, risings = carries & ~rolls, carries & rolls
    starts = np.searchsorted(phase_indices(motion.phases, log.time), np.arange(len(motion.phases) + 1))
    for phase, first, end in zip(motion.phases, starts[:-1], starts[1:], strict=True):
        for flat, rising in product(product((False, True), repeat=len(feet)), repeat=2):
            rows = first + np.flatnonzero(
                (flats[first:end] == flat).all(axis=1) & (risings[first:end] == rising).all(axis=1)
            )
            if not len(rows):
                continue
            on = dict(zip(feet, np.logical_or(flat, rising), strict=True))
            standing = {foot: pose for foot, pose in phase.feet.items() if on[foot]}
            up = tuple(foot for foot, up in zip(feet, rising, strict=True) if up and foot in standing)
            if standing:
                yield rows, support_polygon(motion.robot, Phase(phase.start, phase.end, standing, rising=up))


def ground_heights(motion: Motion, times: np.ndarray) -> np.ndarray:
    """Height of the ground at times (T,) [m]: the mean of what the planned feet stand on, the last one in flights."""
    heights, height = [], 0.0
    for phase in motion.phases:
        if phase.feet:
            height = float(np.mean([pose.translation[2] for pose in phase.feet.values()]))
        heights.append(height)
    return np.array(heights)[phase_indices(motion.phases, times)]


def support_extents(log: RunLog, motion: Motion) -> np.ndarray:
    """Least and greatest x and y of the planned support at every tick [m], (T, 2, 2); nan without support."""
    sides = np.full((log.ticks, 2, 2), np.nan)
    for rows, polygon in planned_support(log, motion):
        sides[rows] = [polygon.vertices.min(axis=0), polygon.vertices.max(axis=0)]
    return sides
