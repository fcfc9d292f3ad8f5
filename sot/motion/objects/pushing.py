"""How fast a thing on a joint may be pushed: a push never pulls, so that only the joint itself can brake the thing."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.human.human import Human
from sot.motion.objects.demonstration import HandledObjects, ObjectPath
from sot.motion.objects.events import ContactPlan
from sot.robots.things.thing import Thing

Array = NDArray[np.float64]

BRAKING_SHARE = 0.6
"""Share of what a joint brakes by itself that a path may ask for: the rest is the force with which the hand pushes."""
COASTING_SHARE = 0.02
"""Share of its way that a thing may still coast when the path has ended: viscous damping alone never ends a motion."""
MAX_SLOWNESS = 20.0
"""Times longer than the demonstration that a push may take at most."""


@dataclass(frozen=True)
class PacedDemonstration:
    """A demonstration that is slow enough for what is pushed in it.

    Attributes:
        human, handled, contacts: On the slower clock.
        remarks: What became slower, a sentence each.
    """

    human: Human
    handled: HandledObjects
    contacts: ContactPlan
    remarks: tuple[str, ...]


def paced_for_pushing(
    human: Human, handled: HandledObjects, contacts: ContactPlan, things: Iterable[Thing]
) -> PacedDemonstration:
    """A demonstration slowed down where a thing on a joint moves faster than a hand that only pushes could stop it.

    Args:
        human: At the rate of the objects.
        handled: Its objects.
        contacts: What touches when.
        things: The robot's, by the objects' names, as the controller knows them.

    Raises:
        InputError: Nothing brakes such a thing, or next to nothing.
    """
    known: Mapping[str, Thing] = {thing.name: thing for thing in things}
    times, remarks = np.arange(human.count) / handled.rate, []
    clock = times
    for name, path in handled.objects.items():
        if path.hinged and name in known:
            own = pushing_clock(known[name], joint_path(known[name], path)[: human.count], times)
            added = float(own[-1] - times[-1])
            if added > 0.5 / handled.rate:
                remarks.append(f"{name} is pushed {added:.1f} s longer than shown: nothing but its own joint brakes it")
            # Each interval of all paths takes as long as the slowest of them needs.
            clock = np.concatenate([[0.0], np.cumsum(np.maximum(np.diff(clock), np.diff(own)))])
    if not remarks:
        return PacedDemonstration(human, handled, contacts, ())
    frames = np.arange(round(clock[-1] * handled.rate) + 1) / handled.rate
    shown = np.interp(frames, clock, times)
    events = [replace(event, time=float(np.interp(event.time, times, clock))) for event in contacts.events]
    return PacedDemonstration(
        human.resampled_at(shown, handled.rate),
        handled.resampled_at(shown),
        ContactPlan(contacts.initial, tuple(events)),
        tuple(remarks),
    )


def joint_path(thing: Thing, path: ObjectPath) -> Array:
    """Coordinate (T,) of the joint of a thing that turns as far as the human's object does [rad]."""
    turns = np.array([pin.log3(turn @ path.rotation[0].T) for turn in path.rotation])
    axis = thing.model.joints[1].shortname()[-1].lower()
    coordinate: Array = thing.rest[0] + turns[:, "xyz".index(axis) if axis in "xyz" else 2]
    return coordinate


def pushing_clock(thing: Thing, coordinate: Array, times: Array) -> Array:
    """Times (T,) at which a thing is at the coordinates (T,) that it has at `times` (T,), as late as pushing needs [s].

    With inertia I, damping c and a resistance r of springs, friction and weight, what only pushes may ask for
    ``q̈ >= -(c q̇ + r) / I``. From the end of each way in one direction the speed that this allows is followed back.

    Raises:
        InputError: It would take too long by far.
    """
    steps = np.diff(coordinate)
    intervals = np.diff(times)
    for first, last in _ways(steps):
        most = _stoppable_speeds(thing, coordinate[first : last + 1])
        mean = 0.5 * (most[1:] + most[:-1])
        with np.errstate(divide="ignore", invalid="ignore"):
            needed = np.abs(steps[first:last]) / mean
        intervals[first:last] = np.maximum(intervals[first:last], np.where(steps[first:last] == 0.0, 0.0, needed))
    clock: Array = np.concatenate([[0.0], np.cumsum(intervals)])
    if not clock[-1] <= MAX_SLOWNESS * times[-1]:
        raise InputError(
            f"{thing.name}: pushing cannot stop it, and its joint hardly brakes it (damping {thing.damping[0]:g}"
            f" N m s/rad, spring {thing.stiffness[0]:g} N m/rad): give it more damping, or a spring"
        )
    return clock


def _ways(steps: Array) -> list[tuple[int, int]]:
    """First and last frame of each way in one direction."""
    ends = [0]
    direction = 0.0
    for k, sign in enumerate(np.sign(steps).tolist()):
        if sign and direction and sign != direction:
            ends.append(k)
        direction = sign or direction
    ends.append(len(steps))
    return list(pairwise(ends))


def _stoppable_speeds(thing: Thing, coordinate: Array) -> Array:
    """Greatest speeds (n,) at coordinates (n,) in one direction from which the joint alone stops the thing in time."""
    speeds = np.zeros(len(coordinate))
    way = coordinate[-1] - coordinate[0]
    direction, data = np.sign(way), thing.model.createData()
    step, q = COASTING_SHARE * abs(way), np.array([coordinate[-1]])
    speed = 0.0
    for k in range(len(coordinate) - 1, -1, -1):
        if k < len(coordinate) - 1:
            step = abs(coordinate[k + 1] - coordinate[k])
        q[0] = coordinate[k]
        inertia = float(pin.crba(thing.model, data, q)[0, 0])
        weight = float(pin.computeGeneralizedGravity(thing.model, data, q)[0])
        spring = float(thing.stiffness[0] * (q[0] - thing.spring_reference[0]))
        resistance = float(direction) * (weight + spring) + float(thing.friction[0])
        # v_k² - v_k+1² = 2 step (c (v_k + v_k+1) / 2 + r) share / I
        viscous = BRAKING_SHARE * step * float(thing.damping[0]) / inertia
        steady = speed**2 + viscous * speed + 2.0 * BRAKING_SHARE * step * resistance / inertia
        speed = 0.5 * viscous + float(np.sqrt(max(0.25 * viscous**2 + steady, 0.0)))
        speeds[k] = speed
    return speeds
