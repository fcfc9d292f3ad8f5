"""A dancer put where the robot can follow its steps: in the robot's size, along a path whose strides are in reach."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from sot.motion.footholds import Reach, headings, places
from sot.motion.footwork import Stand, Step, ground, stands, steps
from sot.motion.human import SIDES, Human
from sot.motion.stance import STANDING, Build
from sot.motion.timetable import timetable

Array = NDArray[np.float64]

PATH_HZ = 0.5  # slower than this, the way of the waist is a path through the room; faster, dancing on the spot
SHIFT_HZ = 1.0  # how fast the body follows where its feet had to be put elsewhere
OFF = 0.10  # m that a foothold may be off its place
KEPT = 0.9  # of the footholds, not farther off than that
SCALES = np.linspace(1.0, 0.3, 15)  # of the path, from the longest


@dataclass(frozen=True)
class Travel:
    """Where and when a robot steps, and the dancer to match.

    Attributes:
        human: the dancer in the robot's size, over its feet.
        steps: in order of time.
        stands: foot -> where it stands before, between and after its steps.
        places: foot -> where the dancer's does, in the robot's size along the scaled path.
        lifts: how high the dancer's foot gets in each step [m], in the robot's size.
        scale: of the path beyond the ratio of leg lengths, 1 if its strides are in reach.
    """

    human: Human
    steps: tuple[Step, ...]
    stands: Mapping[str, Sequence[Stand]]
    places: Mapping[str, Sequence[Stand]]
    lifts: tuple[float, ...]
    scale: float


def travel(human: Human, build: Build, reach: Reach) -> Travel:
    """Steps and footholds for a human on the motion's time line.

    The path is scaled down, as a whole, until nearly all footholds are near their place; the others are moved by the
    least, and the body with them.
    """
    human = human.scaled(build.leg / human.leg)
    feet = {f"{side}_foot": ground(human, side) for side in SIDES}
    moves = steps(feet, human.rate, human.leg)
    human = _from_start(human, stands(feet, moves, human.rate), build)
    feet = {f"{side}_foot": ground(human, side) for side in SIDES}
    own = stands(feet, moves, human.rate)
    timed = timetable(moves, (human.count - 1) / human.rate)
    turned = headings(own, timed, reach)
    off = {foot: turned[foot] - np.array([stand.heading for stand in own[foot]]) for foot in own}
    human = _turned(human, _between({foot: off[foot][:, None] for foot in off}, timed, human)[:, 0])
    for scale in SCALES:
        scaled = _path_scaled(human, float(scale))
        own = stands({f"{side}_foot": ground(scaled, side) for side in SIDES}, moves, human.rate)
        found = places(own, turned, timed, reach)
        moved = {
            foot: np.array([(a.x - b.x, a.y - b.y) for a, b in zip(found[foot], own[foot], strict=True)])
            for foot in own
        }
        far = np.linalg.norm(np.vstack(list(moved.values())), axis=1)
        if np.quantile(far, KEPT) <= OFF:
            break
    lifts = tuple(
        float(feet[move.foot].lift[round(move.lift * human.rate) : round(move.land * human.rate) + 1].max())
        for move in moves
    )
    return Travel(_shifted(scaled, _between(moved, timed, human)), timed, found, own, lifts, float(scale))


def _from_start(human: Human, own: Mapping[str, Sequence[Stand]], build: Build) -> Human:
    """Turned and moved so that the first stands are about the origin of the robot's feet, facing X."""
    first = [feet[0] for feet in own.values()]
    heading = np.angle(np.sum([np.exp(1j * stand.heading) for stand in first]))
    centre = np.mean([(stand.x, stand.y) for stand in first], axis=0)
    height = np.percentile(np.min([human.points[f"{side}_ankle"][:, 2] for side in SIDES], axis=0), STANDING)
    cosine, sine = np.cos(heading), np.sin(heading)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    origin = np.array([*centre, height])
    return replace(
        human,
        points={name: build.ankles + (place - origin) @ turn.T for name, place in human.points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )


def _turned(human: Human, angle: Array) -> Human:
    """Turned by an angle (T,) [rad] about its waist."""
    cosine, sine, nought = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    turn = np.array([[cosine, -sine, nought], [sine, cosine, nought], [nought, nought, nought + 1.0]])
    turn = turn.transpose(2, 0, 1)
    waist = human.points["waist"]
    return replace(
        human,
        points={name: waist + np.einsum("tij,tj->ti", turn, at - waist) for name, at in human.points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )


def _path_scaled(human: Human, scale: float) -> Human:
    """With its way through the room scaled from where it begins, what it does on the spot left as it is."""
    path = _slow(human.points["waist"][:, :2], human.rate, PATH_HZ)
    return _shifted(human, (scale - 1.0) * (path - path[0]))


def _shifted(human: Human, by: Array) -> Human:
    """Moved by (T, 2) [m]."""
    shift = np.column_stack([by, np.zeros(len(by))])
    return replace(human, points={name: place + shift for name, place in human.points.items()})


def _between(values: Mapping[str, Array], steps: Sequence[Step], human: Human) -> Array:
    """What belongs to the stands, (n, d) a foot, over time (T, d): the mean of the feet that stand, smoothly."""
    times = human.times
    total, weight = np.zeros((len(times), next(iter(values.values())).shape[1])), np.zeros(len(times))
    for foot, own in values.items():
        moves = [step for step in steps if step.foot == foot]
        begins = [0.0, *(step.land for step in moves)]
        ends = [*(step.lift for step in moves), np.inf]
        for value, begin, end in zip(own, begins, ends, strict=True):
            stands_here = (times >= begin) & (times <= end)
            total[stands_here] += value
            weight[stands_here] += 1.0
    return _slow(total / weight[:, None], human.rate, SHIFT_HZ)


def _slow(values: Array, rate: float, cutoff: float) -> Array:
    padding = min(len(values) - 1, round(rate / cutoff))
    return sosfiltfilt(butter(2, cutoff, fs=rate, output="sos"), values, axis=0, padlen=padding)
