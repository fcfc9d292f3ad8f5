"""Contact events found in a demonstration: feet that step, hands that move with an object, objects that lie still."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.footwork import find_steps, foot_track
from sot.motion.feet.stance import LEAD_IN_TIME, human_on_time_line
from sot.motion.human.human import SIDES, Human
from sot.motion.objects.demonstration import FACES, HandledObjects, LevelSurface, ObjectPath
from sot.motion.objects.events import ROBOT, WORLD, Change, ContactEvent, ContactPlan, SurfaceName, SurfacePair

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

PALM_FROM_WRIST = 0.32  # forearm lengths: of the middle of the palm
NEAR_OBJECT = 0.09  # arm lengths: a palm nearer to an object's face may touch it
LEAVING_SPEED, STAYING_SPEED = 0.12, 0.08  # arm lengths/s, of a palm along an object: faster it leaves, slower it stays
MOVED_DISTANCE = 0.1  # arm lengths, by which a hand moves an object, or it only was near
NEAR_SURFACE = 0.03  # leg lengths: an object whose lowest point is nearer to a level surface may lie on it
RESTING_SPEED = 0.015  # leg lengths/s: a slower object lies still
STANDING_SPEED = 0.05  # leg lengths/s: an ankle that is slower stands
MIN_CONTACT_TIME = 0.2  # s: what touches for a shorter time has not touched
FLOOR = SurfaceName(WORLD, "floor")


def find_contacts(human: Human, handled: HandledObjects) -> ContactPlan:
    """The contacts of a demonstration: those at its start and the events that change them, in order of time.

    A hand holds an object while its palm is near a face of it and moves with it, if the object moves in that time. An
    object lies on a level surface, or on the floor, while it is near above it and still. Feet stand but for their
    steps, as `footwork.find_steps` finds them.

    Args:
        human: The human; where its clip goes on after the objects' paths or the other way round, the rest is left out.
        handled: Its objects.
    """
    human = human.resampled(handled.rate)
    spans: list[tuple[SurfacePair, float, float]] = []
    for name, path in handled.objects.items():
        count = min(human.count, len(path.position))
        path = replace(path, position=path.position[:count], rotation=path.rotation[:count])
        for side in SIDES:
            spans += _holding_spans(human, side, name, path)
        if not path.hinged:
            spans += _lying_spans(human.leg, handled, name, path)
    initial, events = list(_feet_on_floor()), list(_steps(human))
    for pair, start, end in spans:
        if start > 0.0:
            events.append(ContactEvent(start, "make", pair))
        else:
            initial.append(pair)
        if np.isfinite(end):
            events.append(ContactEvent(end, "break", pair))
    return ContactPlan(tuple(initial), tuple(sorted(events, key=lambda event: event.time)))


def palm_path(human: Human, side: str) -> Array:
    """The middle of a human's palm over time (T, 3) [m], the hand taken to be in line with the forearm."""
    elbow, wrist = human.points[f"{side}_elbow"], human.points[f"{side}_wrist"]
    palm: Array = wrist + PALM_FROM_WRIST * (wrist - elbow)
    return palm


def _holding_spans(human: Human, side: str, name: str, path: ObjectPath) -> list[tuple[SurfacePair, float, float]]:
    """Pair, start and end [s] of each time in which a hand holds an object; the end is infinite if it never lets go."""
    local = path.local(palm_path(human, side)[: len(path.position)])
    outside = local - np.clip(local, -0.5 * path.size, 0.5 * path.size)
    near = np.linalg.norm(outside, axis=1) < NEAR_OBJECT * human.arm
    speed = np.linalg.norm(np.gradient(local, 1.0 / human.rate, axis=0), axis=1) / human.arm
    spans = []
    for first, last in _runs(near & _calm(speed), round(MIN_CONTACT_TIME * human.rate)):
        moved = np.linalg.norm(path.position[first:last] - path.position[first], axis=1).max()
        if moved > MOVED_DISTANCE * human.arm:
            face = _nearest_face(path.size, local[first:last].mean(axis=0))
            pair = SurfacePair(SurfaceName(ROBOT, f"{side}_hand"), SurfaceName(name, face))
            spans.append((pair, first / human.rate, last / human.rate if last < len(near) else np.inf))
    return spans


def _lying_spans(
    leg: float, handled: HandledObjects, name: str, path: ObjectPath
) -> list[tuple[SurfacePair, float, float]]:
    """Pair, start and end [s] of each time in which an object lies on a level surface of the world or on the floor."""
    floor = LevelSurface(np.zeros(3), np.full(2, np.inf))
    still = np.linalg.norm(np.gradient(path.position, 1.0 / handled.rate, axis=0), axis=1) < RESTING_SPEED * leg
    lowest = path.position[:, 2] - 0.5 * np.abs(path.rotation[:, 2, :]) @ path.size
    spans = []
    for surface, level in {**handled.surfaces, FLOOR.surface: floor}.items():
        above = np.all(np.abs(path.position[:, :2] - level.centre[:2]) < 0.5 * level.size, axis=1)
        lying = above & still & (np.abs(lowest - level.centre[2]) < NEAR_SURFACE * leg)
        for first, last in _runs(lying, round(MIN_CONTACT_TIME * handled.rate)):
            downward = path.rotation[first].T @ [0.0, 0.0, -1.0]
            pair = SurfacePair(SurfaceName(name, _face_towards(downward)), SurfaceName(WORLD, surface))
            spans.append((pair, first / handled.rate, last / handled.rate if last < len(lying) else np.inf))
    return spans


def _feet_on_floor() -> Iterator[SurfacePair]:
    for side in SIDES:
        yield SurfacePair(SurfaceName(ROBOT, f"{side}_foot"), FLOOR)


def _steps(human: Human) -> Iterator[ContactEvent]:
    """Events of the feet: they stand at the start and at the end, and leave the floor for each step between."""
    on_line = human_on_time_line(human, human.rate)
    for step in find_steps({f"{side}_foot": foot_track(on_line, side) for side in SIDES}, human.rate, human.leg):
        pair = SurfacePair(SurfaceName(ROBOT, step.foot), FLOOR)
        ankle = on_line.points[step.foot.replace("foot", "ankle")]
        moving = np.linalg.norm(np.gradient(ankle, 1.0 / human.rate, axis=0), axis=1) > STANDING_SPEED * human.leg
        lift, land = round(step.lift * human.rate), round(step.land * human.rate)
        while lift > 0 and moving[lift - 1]:  # a step counts as one from where it is clearly seen
            lift -= 1
        while land < len(moving) - 1 and moving[land]:
            land += 1
        changes: tuple[tuple[Change, int], ...] = (("break", lift), ("make", land))
        for change, frame in changes:
            yield ContactEvent(max(frame / human.rate - LEAD_IN_TIME, 0.0), change, pair)


def _calm(speed: Array) -> Flags:
    """Flags (T,) of frames with a speed below the lower threshold, and those around them below the upper one."""
    flags, calm = np.zeros(len(speed), dtype=bool), False
    for k, value in enumerate(speed):
        calm = bool(value < STAYING_SPEED or (calm and value < LEAVING_SPEED))
        flags[k] = calm
    return flags


def _runs(flags: Flags, shortest: int) -> list[tuple[int, int]]:
    """Start and end (exclusive) of each run of True that is long enough; shorter gaps between two runs are closed."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))).tolist()
    joined: list[tuple[int, int]] = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if joined and first - joined[-1][1] < shortest:
            joined[-1] = joined[-1][0], last
        else:
            joined.append((first, last))
    return [(first, last) for first, last in joined if last - first >= shortest]


def _nearest_face(size: Array, point: Array) -> str:
    """The face of a box of a size that a point near its surface is at."""
    return min(FACES, key=lambda face: abs(0.5 * size[FACES[face][0]] - FACES[face][1] * point[FACES[face][0]]))


def _face_towards(direction: Array) -> str:
    return max(FACES, key=lambda face: FACES[face][1] * direction[FACES[face][0]])
