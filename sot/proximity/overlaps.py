"""Remarks on plans that bring parts of a robot into one another."""

import numpy as np
import pinocchio as pin

from sot.robots.robot import Robot

Array = np.ndarray

OVERLAP_CHECK_PERIOD = 0.05
"""Interval at which a motion is looked at for shapes that overlap [s]."""


def overlap_remarks(robot: Robot, times: Array, q: Array) -> list[str]:
    """Say where a motion brings shapes into each other that may collide: the pair that does so most, and how many do.

    Args:
        robot: The robot.
        times: Of the configurations, shape (n,) [s].
        q: Configurations, shape (n, nq); a few of each second are looked at.
    """
    data, results = robot.model.createData(), robot.shapes.createData()
    rows = [int(k) for k in np.searchsorted(times, np.arange(times[0], times[-1], OVERLAP_CHECK_PERIOD))]
    depths = np.zeros((len(rows), len(results.distanceResults)))
    for depth, row in zip(depths, rows, strict=True):
        pin.computeDistances(robot.model, data, robot.shapes, results, q[row])
        depth[:] = [-result.min_distance for result in results.distanceResults]
    overlapping = int((depths > 0.0).any(axis=0).sum()) if depths.size else 0
    if not overlapping:
        return []
    row, k = divmod(int(depths.argmax()), depths.shape[1])
    pair, shapes = robot.shapes.collisionPairs[k], robot.shapes.geometryObjects
    first, second = (shapes[index].name for index in (pair.first, pair.second))
    others = f", and {overlapping - 1} other pairs do so" if overlapping > 1 else ""
    depth_mm, time = 1e3 * depths[row, k], times[rows[row]]
    return [f"The plan brings {first} and {second} {depth_mm:.0f} mm into each other at {time:.2f} s{others}."]
