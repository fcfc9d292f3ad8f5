"""A dancer's way through the room, cut into pieces that can be scaled one by one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.motion.human.human import Human
from sot.smooth import low_passed

Array = NDArray[np.float64]

PATH_HZ = 0.5  # slower than this, the way of the waist is a path through the room; faster, dancing on the spot
PIECE = 0.5  # s
SHORTENED = 0.15  # m, of a foothold off its place, that costs as much as one piece shortened to nothing
UNEVEN = 0.10  # m, that costs as much as one piece shortened to nothing next to one left as it is


@dataclass(frozen=True)
class Way:
    """The way of a human at its frames, scale 1 and linear between the ends of pieces.

    Attributes:
        carry: (T, 2, K) what each of K pieces adds to the place at a frame for a scale of one [m]; their sum over K is
            the way from where it begins.
        stiffness: (K, K) price of scales that differ from one, and from their neighbours [m²].
    """

    carry: Array
    stiffness: Array

    @staticmethod
    def of(human: Human) -> "Way":
        at = low_passed(human.points["waist"][:, :2], human.rate, PATH_HZ)
        count = max(2, round(human.duration / PIECE) + 1)
        ends = np.linspace(0.0, human.duration, count)
        middles = human.times[:-1] + 0.5 / human.rate
        share = np.maximum(0.0, 1.0 - np.abs(middles[:, None] - ends) / (ends[1] - ends[0]))
        moved = np.diff(at, axis=0)[:, :, None] * share[:, None, :]
        carry = np.concatenate([np.zeros((1, 2, count)), np.cumsum(moved, axis=0)])
        uneven = np.diff(np.eye(count), axis=0)
        return Way(carry, SHORTENED**2 * np.eye(count) + UNEVEN**2 * uneven.T @ uneven)

    def carried(self, stances: Sequence[NDArray[np.int_]]) -> Array:
        """(n, 2, K) mean of `carry` over the frames of each stance."""
        return np.array([self.carry[frames].mean(axis=0) for frames in stances])

    def shift(self, scales: Array) -> Array:
        """By how much (T, 2) scales of the pieces (K,) move a frame [m]."""
        return self.carry @ (scales - 1.0)

    def scaled(self, scales: Array) -> float:
        """Length of the way with its pieces scaled, over that of the way as it is; 1 of none."""
        long, short = (_length(self.carry @ scale) for scale in (np.ones_like(scales), scales))
        return short / long if long > 0.0 else 1.0


def path_length(places: Array, rate: float) -> float:
    """Length of the way through the room of places (T, 2) at a rate [Hz], swaying on the spot left out [m]."""
    return _length(low_passed(places, rate, PATH_HZ))


def _length(way: Array) -> float:
    return float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
