"""The robot's steps and footholds for a dancer, and the dancer to match: in the robot's size, its strides in reach."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.climbing.edge_swing import CLEARANCE, edge_swing_length
from sot.motion.feet.climbing.terrain import MIN_RISE_LEGS, MissingRise, Terrain
from sot.motion.feet.footholds import MIN_PATH_SCALE, LegReach, reachable_footholds, reachable_headings
from sot.motion.feet.footwork import Foothold, FootTrack, Step, find_steps, foot_track, footholds, stance_frames
from sot.motion.feet.path import ScalablePath, path_length
from sot.motion.feet.stance import LEAD_IN_TIME, STANDING_PERCENTILE, Build
from sot.motion.feet.tempo import MAX_SLOWNESS, TIME_GRID, AskedStep, Tempo, step_at_clock, step_tempo
from sot.motion.human.human import SIDES, Human, Remark
from sot.robots.surface import FLOOR
from sot.smooth import low_passed

Array = NDArray[np.float64]

BODY_SHIFT_HZ = 1.0  # up to which the body follows a shift of its footholds
MIN_FOOTFALL_LENGTH = 0.10  # m of a dancer: a shorter step is not counted as a footfall
OMISSIBLE_LENGTH_LEGS = 0.115  # leg lengths: a shorter step may be left out where there is no time for it
OMISSIBLE_TURN, OMISSIBLE_LIFT_LEGS = 1.0, 0.15  # rad and leg lengths: unless it turns or lifts the foot by more
HIGH_LIFT_LEGS, KEPT_TIME_SHARE = 0.3, 0.95  # leg lengths of a lift that keeps so much of the dancer's time in the air
MAX_NAMED_RISES = 3  # in a sentence
MAX_TIME_RESERVED_FOR_TURN = 0.4  # s that a step takes at least for the foot's turn, at most


@dataclass(frozen=True)
class Footfall:
    """A footfall of the dancer: its place along the scaled path (x, y) [m], and when the robot makes it [s], if so."""

    foot: str
    place: tuple[float, float]
    landed: float | None


@dataclass(frozen=True)
class Travel:
    """The robot's steps and footholds, and the dancer to match.

    Attributes:
        human: the dancer in the robot's size, over its feet.
        steps: in order of time.
        moves: the dancer's of the steps, on the same clock: at other times, where the robot could not step at these.
        stands: foot -> its footholds before, between and after its steps.
        places: foot -> those of the dancer, in the robot's size along the scaled path.
        lifts: how high the dancer's foot gets in each step [m], in the robot's size.
        clock: (T,) the robot's time at the frames of the dancer that were given [s].
        scale: length of the path over what leg lengths make of the dancer's, 1 if its strides are in reach.
        path: length of the dancer's way through the room, in the robot's size but not scaled otherwise [m].
        dancer: all steps of the dancer, in the clip's time.
        footfalls: of the dancer's steps longer than MIN_FOOTFALL_LENGTH.
        on_terrain: whether there was more to step on than the floor.
        missing: steps up and down of the dancer for which the terrain has no surface, in the clip's time.
    """

    human: Human
    steps: tuple[Step, ...]
    moves: tuple[Step, ...]
    stands: Mapping[str, Sequence[Foothold]]
    places: Mapping[str, Sequence[Foothold]]
    lifts: tuple[float, ...]
    clock: Array
    scale: float
    path: float
    dancer: tuple[Step, ...]
    footfalls: tuple[Footfall, ...]
    on_terrain: bool = False
    missing: tuple[MissingRise, ...] = ()

    @property
    def climbs(self) -> bool:
        """Whether a foot ever stands on something else than the floor."""
        return any(stand.surface is not FLOOR for own in self.stands.values() for stand in own)


def plan_travel(
    human: Human,
    build: Build,
    reach: LegReach,
    contacts: Sequence[Step] | None,
    keep_lifts: bool = False,
    as_danced: bool = False,
    terrain: Terrain | None = None,
) -> Travel:
    """The robot's steps and footholds for a human on the motion's time line; high lifts may keep their time in the air.

    Its path is scaled down, piece by piece, where its strides are out of reach; footholds are moved by the least, and
    the body with them. As it is danced, nothing is slowed down, and the path keeps its scale. On a terrain,
    footholds are laid onto its surfaces.
    """
    ratio = build.leg / human.leg
    human = human.scaled(ratio)
    feet = _foot_tracks(human)
    dancer = find_steps(feet, human.rate, human.leg) if contacts is None else _steps_in_motion_time(contacts)
    asked = _asked_steps(feet, dancer, human, reach, contacts is not None, keep_lifts, terrain is not None)
    pace = step_tempo(asked, human.times, 1.0 if as_danced else MAX_SLOWNESS)
    human = _human_over_start(human, footholds(feet, dancer, human.rate), build)
    path = path_length(human.points["waist"][:, :2], human.rate)
    human, timed = _human_at_robot_time(human, pace), pace.steps
    moves = [step_at_clock(move.step, pace.clock, human.rate) for move in pace.moves]
    feet = _foot_tracks(human)
    lifts = tuple(_lift_height(feet[move.foot], move, human.rate) for move in moves)
    own = footholds(feet, moves, human.rate)
    turned = reachable_headings(own, timed, reach)
    human = _turned_to_feet(human, own, turned, timed, build)
    way = ScalablePath.of(human)
    asked_at = {
        foot: stance_frames(track, [move for move in moves if move.foot == foot], human.rate)
        for foot, track in feet.items()
    }
    ends = np.round(human.rate * np.array([(step.lift, step.land) for step in timed])).astype(int).reshape(-1, 2)
    found, scales = reachable_footholds(
        footholds(_foot_tracks(human), moves, human.rate),
        turned,
        timed,
        reach,
        {foot: way.carry_at(frames) for foot, frames in asked_at.items()},
        way.stiffness,
        human.points["waist"][ends, :2],
        min_scale=1.0 if as_danced else MIN_PATH_SCALE,
        body_travel=way.carry[ends[:, 1]] - way.carry[ends[:, 0]],
    )
    missing = list[MissingRise]()
    if terrain is not None:
        found, missing = terrain.laid(found, timed, _levels(human, asked_at))
        asked_landings = {step.land: move.step.land for move, step in zip(pace.moves, timed, strict=True)}
        missing = [replace(one, time=asked_landings[one.time] - LEAD_IN_TIME) for one in missing]
    scaled = _human_shifted(human, way.shift(scales))
    own = footholds(_foot_tracks(scaled), moves, human.rate)
    moved = {
        foot: np.array([(a.x - b.x, a.y - b.y) for a, b in zip(found[foot], own[foot], strict=True)]) for foot in own
    }
    made = {move.step: step for move, step in zip(pace.moves, timed, strict=True)}
    long = [move.step for move in asked if move.length > MIN_FOOTFALL_LENGTH * ratio]
    return Travel(
        human=_human_shifted(scaled, _mean_of_standing_feet(moved, timed, human)),
        steps=timed,
        moves=tuple(moves),
        stands=found,
        places=own,
        lifts=lifts,
        clock=pace.clock,
        scale=way.length_ratio(scales),
        path=path,
        dancer=tuple(Step(step.foot, step.lift - LEAD_IN_TIME, step.land - LEAD_IN_TIME) for step in dancer),
        footfalls=_footfalls(scaled, dancer, long, made, pace.clock),
        on_terrain=terrain is not None,
        missing=tuple(missing),
    )


def climb_remarks(remarks: Sequence[Remark], travel: Travel | None) -> list[str]:
    """The sentences of a human's remarks; of its climbs they say what the robot found to step on, if it looked."""
    if travel is None or not travel.on_terrain:
        return [one.words for one in remarks]
    told = [
        one.words.rpartition(";")[0] + "; the robot steps on what the scene has there." if one.climbed else one.words
        for one in remarks
    ]
    if travel.missing:
        where = [f"{one.rise:+.2f} m at {one.time:.1f} s" for one in travel.missing[:MAX_NAMED_RISES]]
        more = f" and {len(travel.missing) - MAX_NAMED_RISES} more" if len(travel.missing) > MAX_NAMED_RISES else ""
        told.append(
            f"The scene has nothing to step on as the dancer does by {', '.join(where)}{more}, in the robot's size:"
            " it stays level there."
        )
    return told


def travel_at_clock(travel: Travel, clock: Array) -> Travel:
    """The same travel at the times (T,) that a clock shows at the human's frames."""
    human = travel.human

    def late(t: float) -> float:
        return TIME_GRID * round(float(np.interp(t, human.times, clock)) / TIME_GRID)

    times = np.arange(round(clock[-1] * human.rate) + 1) / human.rate
    return replace(
        travel,
        human=human.resampled_at(np.interp(times, clock, human.times), human.rate),
        steps=tuple(Step(step.foot, late(step.lift), late(step.land)) for step in travel.steps),
        moves=tuple(step_at_clock(move, clock, human.rate) for move in travel.moves),
        clock=np.interp(travel.clock, human.times, clock),
        footfalls=tuple(
            replace(fall, landed=None if fall.landed is None else late(fall.landed)) for fall in travel.footfalls
        ),
    )


def human_raised(human: Human, by: Array) -> Human:
    """The human raised by (T,) [m]."""
    if not by.any():
        return human
    up = np.outer(by, [0.0, 0.0, 1.0])
    return replace(human, points={name: place + up for name, place in human.points.items()})


def _levels(human: Human, frames: Mapping[str, Sequence[NDArray[np.int_]]]) -> dict[str, list[float]]:
    """The height of what each foot of the human stands on in some stances, each given by its frames [m]."""
    ground = {foot: human.ground.get(foot, np.zeros(human.count)) for foot in frames}
    return {foot: [float(np.median(ground[foot][own])) for own in stances] for foot, stances in frames.items()}


def _foot_tracks(human: Human) -> dict[str, FootTrack]:
    return {f"{side}_foot": foot_track(human, side) for side in SIDES}


def _lift_height(track: FootTrack, move: Step, rate: float) -> float:
    return float(track.lift[round(move.lift * rate) : round(move.land * rate) + 1].max())


def _turned_to_feet(
    human: Human,
    own: Mapping[str, Sequence[Foothold]],
    turned: Mapping[str, Array],
    timed: Sequence[Step],
    build: Build,
) -> Human:
    """The human turned as its feet were, and its pelvis into the range of the hips over them."""
    off = {foot: turned[foot] - np.array([stand.heading for stand in own[foot]]) for foot in own}
    human = _turned_about_waist(
        human, _mean_of_standing_feet({foot: by[:, None] for foot, by in off.items()}, timed, human)[:, 0]
    )
    feet = _mean_of_standing_feet({foot: yaws[:, None] for foot, yaws in turned.items()}, timed, human)[:, 0]
    twist = np.unwrap(np.arctan2(human.frames["pelvis"][:, 1, 0], human.frames["pelvis"][:, 0, 0])) - feet
    twist -= 2.0 * np.pi * np.round(np.median(twist) / (2.0 * np.pi))
    return _turned_about_waist(human, np.clip(twist, -build.turn, build.turn) - twist)


def _footfalls(
    scaled: Human, dancer: Sequence[Step], long: Sequence[Step], made: Mapping[Step, Step], clock: Array
) -> tuple[Footfall, ...]:
    """The footfalls of the dancer's `long` steps along the scaled path, and which of them the robot makes."""
    places = footholds(_foot_tracks(scaled), [step_at_clock(step, clock, scaled.rate) for step in dancer], scaled.rate)
    now, found = dict.fromkeys(places, 0), []
    for step in dancer:
        now[step.foot] += 1
        place = places[step.foot][now[step.foot]]
        if step in long:
            found.append(Footfall(step.foot, (place.x, place.y), made[step].land if step in made else None))
    return tuple(found)


def _steps_in_motion_time(contacts: Sequence[Step]) -> tuple[Step, ...]:
    """Steps from the clip's time to the motion's, in order of their middles."""
    late = [Step(step.foot, step.lift + LEAD_IN_TIME, step.land + LEAD_IN_TIME) for step in contacts]
    return tuple(sorted(late, key=lambda step: step.lift + step.land))


def _asked_steps(
    feet: Mapping[str, FootTrack],
    found: Sequence[Step],
    human: Human,
    reach: LegReach,
    given: bool,
    keep_lifts: bool,
    on_terrain: bool,
) -> list[AskedStep]:
    """The dancer's steps with what each asks of the robot; none may be left out if they were given.

    on_terrain: whether the robot steps up and down where the dancer does.
    """
    own, now, moves = footholds(feet, found, human.rate), dict.fromkeys(feet, 0), []
    for step in found:
        here, there = own[step.foot][now[step.foot] : now[step.foot] + 2]
        now[step.foot] += 1
        moved, turned = float(np.hypot(there.x - here.x, there.y - here.y)), abs(there.heading - here.heading)
        lift = _lift_height(feet[step.foot], step, human.rate)
        rise = _rise(human, step) if on_terrain else 0.0
        way = min(moved, reach.max_stride)
        if rise:
            way = edge_swing_length(way, rise, CLEARANCE * reach.leg_length)
        least = max(
            reach.swing_time(way),
            min(turned / reach.turn_speed, MAX_TIME_RESERVED_FOR_TURN),
        )
        small = (
            not given
            and moved < OMISSIBLE_LENGTH_LEGS * human.leg
            and turned < OMISSIBLE_TURN
            and lift < OMISSIBLE_LIFT_LEGS * human.leg
            and abs(rise) < MIN_RISE_LEGS * human.leg
        )
        moves.append(AskedStep(step, moved, least, small, high=lift > HIGH_LIFT_LEGS * human.leg))
    if not keep_lifts:
        return moves
    return [with_time_kept(move, moves) if move.high else move for move in moves]


def _rise(human: Human, step: Step) -> float:
    """How much higher the human's foot stands after a step than before [m]."""
    if step.foot not in human.ground:
        return 0.0
    ends = np.clip(np.round(human.rate * np.array([step.lift, step.land])).astype(int), 0, human.count - 1)
    lift, land = human.ground[step.foot][ends]
    return float(land - lift)


def with_time_kept(lift: AskedStep, moves: Sequence[AskedStep]) -> AskedStep:
    """A high lift that keeps the dancer's time, unless another step begins or ends meanwhile that has to be made."""
    begin, end = lift.step.lift, lift.step.land
    if any(
        other is not lift and not other.omissible and other.step.lift < end and other.step.land > begin
        for other in moves
    ):
        return lift
    time = KEPT_TIME_SHARE * (lift.step.land - lift.step.lift)
    return replace(lift, min_time=max(lift.min_time, time))


def _human_at_robot_time(human: Human, pace: Tempo) -> Human:
    """The human resampled at the robot's times."""
    times = np.arange(round(pace.clock[-1] * human.rate) + 1) / human.rate
    return human.resampled_at(np.interp(times, pace.clock, human.times), human.rate)


def _human_over_start(human: Human, own: Mapping[str, Sequence[Foothold]], build: Build) -> Human:
    """The human turned and moved so that its first footholds are about the robot's feet, facing X."""
    first = [feet[0] for feet in own.values()]
    heading = np.angle(np.sum([np.exp(1j * stand.heading) for stand in first]))
    centre = np.mean([(stand.x, stand.y) for stand in first], axis=0)
    height = np.percentile(np.min([human.points[f"{side}_ankle"][:, 2] for side in SIDES], axis=0), STANDING_PERCENTILE)
    cosine, sine = np.cos(heading), np.sin(heading)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    origin = np.array([*centre, height])
    return replace(
        human,
        points={name: build.ankles + (place - origin) @ turn.T for name, place in human.points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )


def _turned_about_waist(human: Human, angle: Array) -> Human:
    """The human turned by an angle (T,) [rad] about its waist."""
    cosine, sine, nought = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    turn = np.array([[cosine, -sine, nought], [sine, cosine, nought], [nought, nought, nought + 1.0]])
    turn = turn.transpose(2, 0, 1)
    waist = human.points["waist"]
    return replace(
        human,
        points={name: waist + np.einsum("tij,tj->ti", turn, at - waist) for name, at in human.points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )


def _human_shifted(human: Human, by: Array) -> Human:
    """The human moved by (T, 2) [m]."""
    shift = np.column_stack([by, np.zeros(len(by))])
    return replace(human, points={name: place + shift for name, place in human.points.items()})


def _mean_of_standing_feet(values: Mapping[str, Array], steps: Sequence[Step], human: Human) -> Array:
    """Values of the footholds, (n, d) a foot, over time (T, d): the mean of the feet that stand, made smooth."""
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
    return low_passed(total / weight[:, None], human.rate, BODY_SHIFT_HZ)
