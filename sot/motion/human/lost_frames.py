"""Frames that a tracker lost and filled with the last one that it had: bridged if they are few, told in any case."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.human.human import Human, Remark
from sot.motion.human.mending import bridged

Flags = NDArray[np.bool_]

MIN_HELD_FRAMES = 3  # of the very same pose; fewer are a rate that was doubled
MIN_HELD_TIME = 0.1  # times √(leg / g)
MAX_BRIDGED_TIME = 1.0  # times √(leg / g): longer gaps are left as they are
MIN_SPEED = 0.3  # leg lengths/s, of the fastest point right before or after: who stands still loses nothing


def with_lost_frames_bridged(human: Human) -> Human:
    """The human with held frames interpolated, and a remark for each such stretch.

    A body never is in the very same pose twice: frames that repeat one, to the last digit, in the midst of a move were
    filled in.
    """
    points = np.stack(list(human.points.values()), axis=1)
    speed = np.linalg.norm(np.diff(points, axis=0), axis=2).max(axis=1) * human.rate / human.leg
    same = speed < 1e-7
    edges = np.flatnonzero(np.diff(same.astype(np.int8), prepend=0, append=0))
    shortest = max(MIN_HELD_FRAMES, MIN_HELD_TIME * human.leg_time * human.rate)
    away = np.zeros(human.count, dtype=bool)
    remarks = []
    for first, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):  # frames first .. end are the same
        moving = max(speed[max(first - 1, 0)], speed[min(end, len(speed) - 1)]) > MIN_SPEED
        inside = first > 0 and end < len(speed)
        if end - first < shortest or not (moving and inside):
            continue
        short = end - first <= MAX_BRIDGED_TIME * human.leg_time * human.rate
        away[first + 1 : end + 1] |= short
        start, until = human.start + first / human.rate, human.start + end / human.rate
        what = "bridged there" if short else "danced as it is, motionless"
        remarks.append(Remark(start, until, f"The recording stops from {start:.2f} to {until:.2f} s: it is {what}."))
    if not remarks:
        return human
    return replace(bridged(human, away) if away.any() else human, remarks=(*human.remarks, *remarks))
