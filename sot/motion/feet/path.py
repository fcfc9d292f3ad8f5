"""A dancer's path through the room, cut into pieces that can be scaled one by one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.motion.human.human import Human
from sot.smooth import low_passed

Array = NDArray[np.float64]

PATH_HZ = 0.5  # slower motion of the waist is a path through the room, faster is dancing on the spot
PIECE_TIME = 0.5  # s, length of a piece
SHORTENING_PRICE = 0.25  # leg lengths: a foothold so far off costs as much as one piece scaled to zero
UNEVENNESS_PRICE = (
    0.166  # leg lengths: a foothold so far off costs as much as a piece scaled to zero beside one that is not
)


@dataclass(frozen=True)
class ScalablePath:
    """The path of a human at its frames, linear in the scales of its pieces.

    Attributes:
        carry: (T, 2, K) what each of K pieces at scale 1 adds to the place at a frame [m]; their sum over K is the path
            from where it begins.
        stiffness: (K, K) price of scales that differ from 1, and from their neighbours [m²].
    """

    carry: Array
    stiffness: Array

    @staticmethod
    def of(human: Human) -> "ScalablePath":
        at = low_passed(human.points["waist"][:, :2], human.rate, PATH_HZ)
        count = max(2, round(human.duration / PIECE_TIME) + 1)
        ends = np.linspace(0.0, human.duration, count)
        middles = human.times[:-1] + 0.5 / human.rate
        share = np.maximum(0.0, 1.0 - np.abs(middles[:, None] - ends) / (ends[1] - ends[0]))
        moved = np.diff(at, axis=0)[:, :, None] * share[:, None, :]
        carry = np.concatenate([np.zeros((1, 2, count)), np.cumsum(moved, axis=0)])
        uneven = np.diff(np.eye(count), axis=0)
        stiffness = SHORTENING_PRICE**2 * np.eye(count) + UNEVENNESS_PRICE**2 * uneven.T @ uneven
        return ScalablePath(carry, human.leg**2 * stiffness)

    def carry_at(self, stances: Sequence[NDArray[np.int_]]) -> Array:
        """The mean of `carry` over the frames of each of n stances, (n, 2, K) [m]."""
        return np.array([self.carry[frames].mean(axis=0) for frames in stances])

    def shift(self, scales: Array) -> Array:
        """By how much the scales (K,) of the pieces move each frame, (T, 2) [m]."""
        return self.carry @ (scales - 1.0)

    def length_ratio(self, scales: Array) -> float:
        """The length of the path with its pieces scaled over its own; 1 if it has none."""
        long, short = (_polyline_length(self.carry @ scale) for scale in (np.ones_like(scales), scales))
        return short / long if long > 0.0 else 1.0


def path_length(places: Array, rate: float) -> float:
    """The length of the path through the room of places (T, 2) at a rate [Hz], without swaying on the spot [m]."""
    return _polyline_length(low_passed(places, rate, PATH_HZ))


def _polyline_length(way: Array) -> float:
    return float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
