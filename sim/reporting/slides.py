"""The figures of every slide of a run: how far, how loaded, and where the zero-moment point was meanwhile."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from sim.log import FOOT_SLIDING, RunLog, constant_stretches
from sim.reporting.figures import Figures, Points
from sot.gravity import GRAVITY
from sot.motion.feet.contacts import Phase, phase_indices, support_polygon
from sot.motion.trajectory import Motion
from sot.polygon import Polygon

LIGHT_LOAD_RANGE = 0.02, 0.15
"""Least and greatest load of a foot that slides lightly, in weights of the robot."""
SMOOTHING_WINDOW_S = 0.05
"""Time over which a foot's load and the ZMP are averaged [s]: the floor carries what slides in pulses, tick by tick."""


def worst_of_slides(found: Sequence[Mapping[str, Any]]) -> Figures:
    """Figures over all slides of a run: the total way [m], else each figure's worst; None if nothing slid."""

    def over(name: str, take: Callable[[Iterable[float]], float]) -> float | None:
        return take([slide[name] for slide in found]) if found else None

    return {
        "way_m": over("way_m", sum),
        "contact": over("contact", min),
        "load_min": over("load_min", min),
        "load_max": over("load_max", max),
        "zmp_inside": over("zmp_inside", min),
        "zmp_min_margin_m": over("zmp_min_margin_m", min),
    }


def slide_figures(log: RunLog, motion: Motion) -> list[dict[str, Any]]:
    """Each slide of a foot, in order of time.

    - "foot", "start_s", "end_s": of the contact's sliding.
    - "way_m", "moved_m": length of the foot's way, and how far it was from its start at most.
    - "contact": share of the ticks in which the floor carries the foot.
    - "load", "load_min", "load_max": its normal load, all forces of the floor on it together, in weights of the robot;
      mean over the slide, and extremes of the mean over any `SMOOTHING_WINDOW_S` seconds. "load_raw_max": the
      greatest of a tick. "light": share of the ticks with a load that is `LIGHT_LOAD_RANGE`.
    - "zmp_inside": share of the ticks with the measured ZMP of the whole robot in the soles that stand.
      "zmp_min_margin_m": least distance of its mean over `SMOOTHING_WINDOW_S` seconds from their edge, negative
      outside; "zmp_raw_min_margin_m": of one tick.
    """
    robot, found = motion.robot, []
    for index, foot in enumerate(robot.feet):
        for mode, rows in constant_stretches(log.foot_mode[:, index]):
            if mode != FOOT_SLIDING:
                continue
            place = Points.of(robot, log.q[rows], (foot,)).positions[foot][:, :2]
            load = log.foot_wrench[rows, index, 2] / (robot.mass * GRAVITY)
            mean, soles = _moving_mean(load, log.period), _standing_support(log, motion, foot, rows)
            margin = _margin_in_support(soles, log.zmp_measured[rows])
            found.append(
                {
                    "foot": foot,
                    "start_s": float(log.time[rows.start]),
                    "end_s": float(log.time[rows.stop - 1] + log.period),
                    "way_m": float(np.linalg.norm(np.diff(place, axis=0), axis=1).sum()),
                    "moved_m": float(np.linalg.norm(place - place[0], axis=1).max()),
                    "contact": float(np.mean(load > 0.0)),
                    "load": float(load.mean()),
                    "load_min": float(mean.min()),
                    "load_max": float(mean.max()),
                    "load_raw_max": float(load.max()),
                    "light": float(np.mean((load >= LIGHT_LOAD_RANGE[0]) & (load <= LIGHT_LOAD_RANGE[1]))),
                    "zmp_inside": float(np.mean(margin >= 0.0)),
                    "zmp_raw_min_margin_m": float(margin.min()),
                    "zmp_min_margin_m": float(
                        _margin_in_support(soles, _moving_mean(log.zmp_measured[rows], log.period)).min()
                    ),
                }
            )
    return sorted(found, key=lambda slide: slide["start_s"])


def _moving_mean(values: np.ndarray, period: float) -> np.ndarray:
    """Means (n,) or (n, 2) over `SMOOTHING_WINDOW_S` seconds, for as many instants as have them."""
    window = min(max(1, round(SMOOTHING_WINDOW_S / period)), len(values))
    return np.lib.stride_tricks.sliding_window_view(values, window, axis=0).mean(axis=-1)


def _standing_support(log: RunLog, motion: Motion, foot: str, rows: slice) -> Polygon | None:
    """Support polygon of the feet that the motion has stand while one foot slides; None if none stands."""
    middle = log.time[(rows.start + rows.stop) // 2]
    phase = motion.phases[int(phase_indices(motion.phases, middle))]
    others = {other: pose for other, pose in phase.feet.items() if other != foot}
    return support_polygon(motion.robot, Phase(0.0, 0.0, others)) if others else None


def _margin_in_support(soles: Polygon | None, places: np.ndarray) -> np.ndarray:
    """Distance (n,) of points to the soles' edge [m], negative outside or where there is none."""
    if soles is None:
        return np.full(len(places), -np.inf)
    return np.nan_to_num(soles.margin(places), nan=-np.inf)
