"""A dancer put where the robot can follow its steps: in the robot's size, along a path whose strides are in reach."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.footholds import Reach, headings, places
from sot.motion.feet.footwork import Ground, Stand, Step, ground, standing, stands, steps
from sot.motion.feet.path import Way, path_length
from sot.motion.feet.stance import LEAD, STANDING, Build
from sot.motion.feet.tempo import Move, Tempo, at_clock, tempo
from sot.motion.feet.timetable import GRID
from sot.motion.human.human import SIDES, Human
from sot.smooth import low_passed

Array = NDArray[np.float64]

SHIFT_HZ = 1.0  # how fast the body follows where its feet had to be put elsewhere
FOOTFALL = 0.10  # m, a step of the dancer that counts
SMALL = 0.115  # leg lengths, a shorter step may be left out where there is no time for it
TURNED, LIFTED = 1.0, 0.15  # rad and leg lengths, unless it turns or lifts the foot by more
LONGEST = 0.4  # s, that a step may be drawn out to turn the foot


@dataclass(frozen=True)
class Footfall:
    """Where a foot of the dancer lands along the scaled path (x, y) [m], and when the robot's does [s], if it does."""

    foot: str
    place: tuple[float, float]
    landed: float | None


@dataclass(frozen=True)
class Travel:
    """Where and when a robot steps, and the dancer to match.

    Attributes:
        human: the dancer in the robot's size, over its feet.
        steps: in order of time.
        stands: foot -> where it stands before, between and after its steps.
        places: foot -> where the dancer's does, in the robot's size along the scaled path.
        lifts: how high the dancer's foot gets in each step [m], in the robot's size.
        clock: (T,) the robot's time at the frames of the dancer that were given [s].
        scale: length of the path over what leg lengths make of the dancer's, 1 if its strides are in reach.
        path: length of the dancer's way through the room, in the robot's size but not scaled otherwise [m].
        dancer: all steps of the dancer, in the clip's time.
        footfalls: of the dancer's steps longer than FOOTFALL.
    """

    human: Human
    steps: tuple[Step, ...]
    stands: Mapping[str, Sequence[Stand]]
    places: Mapping[str, Sequence[Stand]]
    lifts: tuple[float, ...]
    clock: Array
    scale: float
    path: float
    dancer: tuple[Step, ...]
    footfalls: tuple[Footfall, ...]


def travel(human: Human, build: Build, reach: Reach, contacts: Sequence[Step] | None) -> Travel:
    """Steps and footholds for a human on the motion's time line.

    Its path is scaled down, piece by piece, where its strides are out of reach; footholds are moved by the least, and
    the body with them.
    """
    ratio = build.leg / human.leg
    human = human.scaled(ratio)
    feet = _grounds(human)
    dancer = steps(feet, human.rate, human.leg) if contacts is None else _on_time_line(contacts)
    asked = _moves(feet, dancer, human, reach, given=contacts is not None)
    pace = tempo(asked, human.times)
    human = _from_start(human, stands(feet, dancer, human.rate), build)
    path = path_length(human.points["waist"][:, :2], human.rate)
    human, timed = _warped(human, pace), pace.steps
    moves = [at_clock(move.step, pace.clock, human.rate) for move in pace.moves]
    feet = _grounds(human)
    lifts = tuple(_lift(feet[move.foot], move, human.rate) for move in moves)
    own = stands(feet, moves, human.rate)
    turned = headings(own, timed, reach)
    human = _faced(human, own, turned, timed, build)
    way = Way.of(human)
    asked_at = {
        foot: standing(track, [move for move in moves if move.foot == foot], human.rate) for foot, track in feet.items()
    }
    found, scales = places(
        stands(_grounds(human), moves, human.rate),
        turned,
        timed,
        reach,
        {foot: way.carried(frames) for foot, frames in asked_at.items()},
        way.stiffness,
    )
    scaled = _shifted(human, way.shift(scales))
    own = stands(_grounds(scaled), moves, human.rate)
    moved = {
        foot: np.array([(a.x - b.x, a.y - b.y) for a, b in zip(found[foot], own[foot], strict=True)]) for foot in own
    }
    made = {move.step: step for move, step in zip(pace.moves, timed, strict=True)}
    long = [move.step for move in asked if move.length > FOOTFALL * ratio]
    return Travel(
        human=_shifted(scaled, _between(moved, timed, human)),
        steps=timed,
        stands=found,
        places=own,
        lifts=lifts,
        clock=pace.clock,
        scale=way.scaled(scales),
        path=path,
        dancer=tuple(Step(step.foot, step.lift - LEAD, step.land - LEAD) for step in dancer),
        footfalls=_footfalls(scaled, dancer, long, made, pace.clock),
    )


def slowed_travel(travel: Travel, clock: Array) -> Travel:
    """The same at the times (T,) that a clock shows at the human's frames."""
    human = travel.human

    def late(t: float) -> float:
        return GRID * round(float(np.interp(t, human.times, clock)) / GRID)

    times = np.arange(round(clock[-1] * human.rate) + 1) / human.rate
    return replace(
        travel,
        human=human.resampled_at(np.interp(times, clock, human.times), human.rate),
        steps=tuple(Step(step.foot, late(step.lift), late(step.land)) for step in travel.steps),
        clock=np.interp(travel.clock, human.times, clock),
        footfalls=tuple(
            replace(fall, landed=None if fall.landed is None else late(fall.landed)) for fall in travel.footfalls
        ),
    )


def _grounds(human: Human) -> dict[str, Ground]:
    return {f"{side}_foot": ground(human, side) for side in SIDES}


def _lift(track: Ground, move: Step, rate: float) -> float:
    return float(track.lift[round(move.lift * rate) : round(move.land * rate) + 1].max())


def _faced(
    human: Human,
    own: Mapping[str, Sequence[Stand]],
    turned: Mapping[str, Array],
    timed: Sequence[Step],
    build: Build,
) -> Human:
    """Turned as its feet had to be, and so that the pelvis is within the range of the hips over them."""
    off = {foot: turned[foot] - np.array([stand.heading for stand in own[foot]]) for foot in own}
    human = _turned(human, _between({foot: by[:, None] for foot, by in off.items()}, timed, human)[:, 0])
    feet = _between({foot: yaws[:, None] for foot, yaws in turned.items()}, timed, human)[:, 0]
    twist = np.unwrap(np.arctan2(human.frames["pelvis"][:, 1, 0], human.frames["pelvis"][:, 0, 0])) - feet
    twist -= 2.0 * np.pi * np.round(np.median(twist) / (2.0 * np.pi))
    return _turned(human, np.clip(twist, -build.turn, build.turn) - twist)


def _footfalls(
    scaled: Human, dancer: Sequence[Step], long: Sequence[Step], made: Mapping[Step, Step], clock: Array
) -> tuple[Footfall, ...]:
    """Where the dancer's long steps land along the scaled path, and which of them the robot makes."""
    places = stands(_grounds(scaled), [at_clock(step, clock, scaled.rate) for step in dancer], scaled.rate)
    now, found = dict.fromkeys(places, 0), []
    for step in dancer:
        now[step.foot] += 1
        place = places[step.foot][now[step.foot]]
        if step in long:
            found.append(Footfall(step.foot, (place.x, place.y), made[step].land if step in made else None))
    return tuple(found)


def _on_time_line(contacts: Sequence[Step]) -> tuple[Step, ...]:
    """Steps in the clip's time in that of the motion, in order of their middles."""
    late = [Step(step.foot, step.lift + LEAD, step.land + LEAD) for step in contacts]
    return tuple(sorted(late, key=lambda step: step.lift + step.land))


def _moves(feet: Mapping[str, Ground], found: Sequence[Step], human: Human, reach: Reach, given: bool) -> list[Move]:
    """What each of the dancer's steps asks of the robot; none may be left out if they were given."""
    own, now, moves = stands(feet, found, human.rate), dict.fromkeys(feet, 0), []
    for step in found:
        here, there = own[step.foot][now[step.foot] : now[step.foot] + 2]
        now[step.foot] += 1
        moved, turned = float(np.hypot(there.x - here.x, there.y - here.y)), abs(there.heading - here.heading)
        lift = _lift(feet[step.foot], step, human.rate)
        least = max(min(moved, reach.stride) / reach.speed, min(turned / reach.turning, LONGEST))
        small = not given and moved < SMALL * human.leg and turned < TURNED and lift < LIFTED * human.leg
        moves.append(Move(step, moved, least, small))
    return moves


def _warped(human: Human, pace: Tempo) -> Human:
    """The human at the robot's times."""
    times = np.arange(round(pace.clock[-1] * human.rate) + 1) / human.rate
    return human.resampled_at(np.interp(times, pace.clock, human.times), human.rate)


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
    return low_passed(total / weight[:, None], human.rate, SHIFT_HZ)
