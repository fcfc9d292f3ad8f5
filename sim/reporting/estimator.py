"""Figures of an estimated state: how far it is from the simulated one."""

from itertools import pairwise
from typing import Any

import numpy as np

from sim.estimation.errors import position_errors, rotation_errors, velocity_errors
from sim.log import RunLog
from sot.motion.feet.footfalls import Footfalls
from sot.motion.trajectory import Motion

FIGURES = (
    *("position_end_m", "position_end_share", "position_max_m", "way_m", "heading_end_deg"),
    *("tilt_rms_deg", "tilt_max_deg", "velocity_rms_m_s"),
)


def estimator_figures(log: RunLog, motion: Motion) -> dict[str, Any]:
    """Errors of the estimated base over a run, None of each where nothing was estimated.

    The position's at the end, also as a share of the way that the feet walked, and its largest; the heading's at the
    end; tilt and velocity (world axes) over all ticks.
    """
    if not log.ticks or not log.base_estimate.shape[1]:
        return dict.fromkeys(FIGURES)
    off = position_errors(log)
    distance, turn, velocity = np.linalg.norm(off, axis=1), rotation_errors(log), velocity_errors(log)
    tilt, way = np.rad2deg(np.linalg.norm(turn[:, :2], axis=1)), _way(motion)
    return {
        "position_end_m": distance[-1],
        "position_end_share": distance[-1] / way if way else None,
        "position_max_m": distance.max(),
        "way_m": way,
        "heading_end_deg": np.rad2deg(turn[-1, 2]),
        "tilt_rms_deg": np.sqrt(np.mean(tilt**2)),
        "tilt_max_deg": tilt.max(),
        "velocity_rms_m_s": np.sqrt(np.mean(np.sum(velocity**2, axis=1))),
    }


def estimate_us(log: RunLog) -> dict[str, Any]:
    """Time of an estimate: median and 99th percentile [µs], None where nothing was estimated."""
    if not log.ticks or not log.base_estimate.shape[1]:
        return dict.fromkeys(("p50", "p99"))
    return {f"p{share}": np.percentile(log.estimate_us, share) for share in (50, 99)}


def _way(motion: Motion) -> float:
    """Horizontal distance that the feet walk by plan, the mean of both [m]."""
    ways = []
    for foot in motion.robot.feet:
        places = [stance.pose.translation[:2] for stance in Footfalls(motion.phases, foot).stances]
        ways.append(sum(float(np.linalg.norm(b - a)) for a, b in pairwise(places)))
    return float(np.mean(ways))
