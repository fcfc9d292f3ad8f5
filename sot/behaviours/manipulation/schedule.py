"""Otani's Algorithm 1 as a schedule: contacts are made and broken when the robot is ready, and tracking waits."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pinocchio as pin

from sot.behaviours.manipulation.clock import DemonstrationClock
from sot.behaviours.manipulation.guide import (
    PoseGuide,
    attached_reference,
    closing_reference,
    fixed_reference,
    placement_of,
)
from sot.behaviours.manipulation.hand_shift import shift_of_hands
from sot.behaviours.manipulation.loss import LossWatch
from sot.behaviours.manipulation.pace import (
    CLOSING_PATIENCE,
    CLOSING_RAMP,
    CLOSING_SPEED,
    COM_TIME,
    LOAD_RAMP,
    MAX_WAIT,
)
from sot.behaviours.manipulation.played import Waiting, played_motion
from sot.behaviours.manipulation.pushes import Pushes
from sot.behaviours.manipulation.waiting import GivenUpError, WaitingSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.motion.objects.events import ContactEvent, ContactSets, SurfacePair, simultaneous
from sot.motion.objects.retarget import RobotDemonstration, Target
from sot.motion.objects.support import support_centre
from sot.motion.trajectory import Motion

Array = np.ndarray
__all__ = ["ManipulationSchedule", "Waiting"]

# Times are in √(leg / g), a quarter of a second for a robot of human size; lengths in leg lengths.
CLOCK_FREQUENCY = 5.0  # 1/√(leg/g), of the demonstration's clock
CLOCK_AT_REST = 1e-3  # rate of the clock below which the demonstration stands still
FACING_SPEED = 0.08  # leg lengths per √(leg/g), mean, on the way to the standoff
MIN_FACING_TIME = 1.6  # √(leg/g)
OVERTRAVEL = 0.08  # leg lengths beyond the expected surface at which an approach is given up
GUIDE_FADE = 3.2  # √(leg/g), in which a free link is back on its path
SHIFT_TIME = 0.6  # √(leg/g), low-pass of what the hands' forces shift the centre of mass by
LOST_TIME = 0.4  # √(leg/g) without any force on all that hold a thing: it is lost
BACKING_OFF_TIME = 6.0  # √(leg/g), after a failure, until the run ends


class ManipulationSchedule(WaitingSchedule):
    """A schedule that leads a robot and its things through a demonstration, contact by contact.

    The demonstration's clock is stopped for each group of events that happen together and runs on when they are done:

    - A contact is made: what makes it goes to its standoff, faces the surface, comes on slowly until it feels a force,
      and only then the contact takes load within a ramp. Once a free thing is held, the centre of mass is that of the
      robot and the thing, led from where it is to where it is to be before anything that supports the thing is taken
      away.
    - A contact is broken: of a support, once the centre of mass is over those that stay; of a hand, once the centre of
      mass is led as the robot's own again. The load fades within a ramp.

    A wait that does not end in time, or a thing that is lost, ends the demonstration: what has not touched withdraws,
    and `failure` says which event and why.

    Args:
        demonstration: What is to be done.
        contacts: Of the stack: pair of surfaces in the events -> contact. Those at the start are fixed, the others off.
        com_shifted_by_hands: Whether the hands' forces shift the centre of mass.

    Attributes:
        clock: Of the demonstration.
        guides: Reference of each of the robot's points that the demonstration leads.
        sets: The sets E1, E2, E3 now.
        history: When they changed, and to what.
        waits: Times in which the demonstration stood still.
    """

    def __init__(
        self,
        demonstration: RobotDemonstration,
        contacts: Mapping[SurfacePair, Contact],
        com_shifted_by_hands: bool = True,
    ) -> None:
        super().__init__(demonstration.system.robot, demonstration.motion.com[0, :2], SHIFT_TIME)
        self.demonstration, self._contacts = demonstration, dict(contacts)
        self._shifted = com_shifted_by_hands
        self.clock = DemonstrationClock(CLOCK_FREQUENCY / self.unit)
        self.guides = {point: PoseGuide(self.clock.pose(path)) for point, path in demonstration.links.items()}
        self.things = {name: PoseGuide(self.clock.pose(path)) for name, path in demonstration.things.items()}
        self.waits: list[Waiting] = []
        plan = demonstration.contacts
        self._tracked = frozenset(pair.first.surface for pair in plan.pairs() if pair.kind != "thing-world")
        self._happened = 0
        self.sets = plan.sets_after(0, self._tracked)
        self.history: list[tuple[float, ContactSets]] = [(0.0, self.sets)]
        self._losses = LossWatch(self._contacts, LOST_TIME * self.unit)
        self._approaching: list[tuple[PoseGuide, pin.SE3]] = []
        pushed = [thing for thing in self.things if not demonstration.system.thing(thing).is_free]
        self._pushes = Pushes(self._contacts, self.things, pushed, self.leg)
        groups = simultaneous(plan.events, self.unit)
        self.extra_time = self.unit * (MAX_WAIT * len(groups) + BACKING_OFF_TIME)
        self._played: list[tuple[tuple[float, float, float], tuple[Array, Array, Array]]] = []

    def played(self) -> Motion:
        """The demonstration's motion as it was played, wait by wait, with the centre of mass as it was led."""
        clock = np.array([state for state, _ in self._played])
        com = np.array([[part[:2] for part in led] for _, led in self._played])
        return played_motion(self.demonstration.motion, clock, com, self.history, self.demonstration.motion.rate)

    def played_times(self) -> Array:
        """The demonstration's time at every tick (T,) [s]."""
        return np.array([time for (time, _, _), _ in self._played])

    def motion_time(self, t: float) -> float:
        """The demonstration's time at the robot's present time [s]."""
        return self.clock.time

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out what is due; returns it in words. Loads are the measured normal forces by the contacts' names."""
        self.clock.advance(t)
        return super().apply(t, stack, loads)

    def observe(self, tick: Tick) -> None:
        """Note the state, and what hands shift the centre of mass by."""
        super().observe(tick)
        if self._shifted:
            held = [pair for pair in self.sets.pairs if pair.second.entity not in self.carried]
            self.com.shift_by(shift_of_hands(tick, held, self._contacts, self._loads), tick.t)
        clock = self.clock
        self._played.append(((clock.time, clock.rate, clock.acceleration), self.com(tick.t)))

    def phases(self) -> Iterator[None]:
        """Algorithm 1, a step a tick."""
        self._follow_com()
        for events in simultaneous(self.demonstration.contacts.events, self.unit):
            yield from self.until(lambda time=events[0].time: self.clock.stopping_time >= time)  # type: ignore[misc]
            begun, self.clock.running = self.t, False
            yield from self.until(lambda: self.clock.rate < CLOCK_AT_REST)
            yield from self._made(events) if events[0].change == "make" else self._broken(events)
            self._happened += len(events)
            self._take_sets()
            self._follow_com()
            self.waits.append(Waiting(", ".join(str(event) for event in events), begun, self.t))
            self.clock.running = True
        yield from self.until(lambda: self.clock.time >= self.demonstration.motion.duration - 1e-6)

    def _made(self, events: Sequence[ContactEvent]) -> Iterator[None]:
        """Contacts are made: face the surfaces, come on until all have touched, take load, take over what is held."""
        yield from self._approach(events)
        yield from self.take_load(*(self._contacts[event.pair] for event in events))
        after = self.demonstration.contacts.sets_after(self._happened + len(events), self._tracked)
        kind = events[0].pair.kind
        if kind == "robot-world":
            self._lead_over_supports(after)
        elif kind == "thing-world":
            for thing in {event.pair.first.entity for event in events}:
                self.things[thing].lead_by(fixed_reference(placement_of(self.things[thing](self.t))), self.t, 0.0)
        else:
            for thing in {event.pair.second.entity for event in events}:
                self._take_hold(thing, after)
            yield from self.settled_com(str(events[0]))

    def _broken(self, events: Sequence[ContactEvent]) -> Iterator[None]:
        """Contacts are broken: the centre of mass is where it stays without them, they give their load away, and go."""
        after = self.demonstration.contacts.sets_after(self._happened + len(events), self._tracked)
        kind = events[0].pair.kind
        if kind == "robot-world":
            self._lead_over_supports(after)
        held = {pair.second.entity for pair in after.pairs if pair.kind == "robot-thing"}
        if kind == "robot-thing":
            self.carried = tuple(thing for thing in self.carried if thing in held)
        if kind != "thing-world":
            yield from self.settled_com(str(events[0]))
        yield from self.give_load(*(self._contacts[event.pair] for event in events))
        if kind == "robot-thing":
            yield from self._withdraw(events)
        for event in events if kind != "thing-world" else ():
            point = self._point(event.pair)
            if kind == "robot-world":
                self.guides[point].start_at(self.measured(point))
            path = self.demonstration.links[point]
            self.guides[point].lead_by(self.clock.pose(path), self.t, GUIDE_FADE * self.unit)

    def _approach(self, events: Sequence[ContactEvent]) -> Iterator[None]:
        """Go to the standoff, and come on slowly until every one has touched."""
        longest, unit = 0.0, self.unit
        self._approaching = []
        for event in events:
            target, guide = self.demonstration.targets[event], self._mover(event)
            goal = target.away(self._body(target), target.standoff)
            way = float(np.linalg.norm(goal.translation - guide(self.t).position))
            duration = unit * max(MIN_FACING_TIME, way / (FACING_SPEED * self.leg))
            guide.lead_by(fixed_reference(goal), self.t, duration)
            longest = max(longest, duration)
            self._approaching.append((guide, goal))
        yield from self.wait(longest)
        begun, speed, left = self.t, CLOSING_SPEED * self.leg / unit, list(events)
        for event, (guide, goal) in zip(events, self._approaching, strict=True):
            target = self.demonstration.targets[event]
            velocity = -speed * (self._body(target).rotation @ target.normal)
            guide.lead_by(closing_reference(goal, velocity, self.t, CLOSING_RAMP * unit), self.t, 0.0)
        farthest = max(self.demonstration.targets[event].standoff for event in events) + OVERTRAVEL * self.leg
        while left:
            for event in [event for event in left if self.is_felt(self._contacts[event.pair])]:
                guide = self._mover(event)
                guide.lead_by(fixed_reference(placement_of(guide(self.t))), self.t, 0.0)
                left.remove(event)
            late = self.t - begun > CLOSING_PATIENCE * (farthest / speed + CLOSING_RAMP * unit)
            if left and (late or self._gap(left[0]) < -OVERTRAVEL * self.leg):
                raise GivenUpError(f"{left[0]}: no touch within {self.t - begun:.1f} s of closing in")
            yield
        self._approaching = []

    def _take_hold(self, thing: str, after: ContactSets) -> None:
        """Lead what holds a thing by the thing's path, from where both are; a free thing's mass counts from now on."""
        placement, t = self.measured(thing), self.t
        self.things[thing].start_at(placement)
        self.things[thing].lead_by(self.clock.pose(self.demonstration.things[thing]), t, GUIDE_FADE * self.unit)
        for pair in after.pairs:
            if pair.kind == "robot-thing" and pair.second.entity == thing:
                point = self._point(pair)
                grip = placement.inverse() * self.measured(point)
                self.guides[point].lead_by(attached_reference(self.things[thing], grip), t, LOAD_RAMP * self.unit)
        if self.demonstration.system.thing(thing).is_free and thing not in self.carried:
            self.carried = (*self.carried, thing)

    def _withdraw(self, events: Sequence[ContactEvent]) -> Iterator[None]:
        """Lead what has let go off to its standoff."""
        longest = 0.0
        for event in events:
            target = next(one for other, one in self.demonstration.targets.items() if other.pair == event.pair)
            guide, goal = self._mover(event), target.away(self._body(target), target.standoff)
            guide.start_at(self.measured(target.mover))
            duration = self.unit * max(MIN_FACING_TIME, target.standoff / (FACING_SPEED * self.leg))
            guide.lead_by(fixed_reference(goal), self.t, duration)
            longest = max(longest, duration)
        yield from self.wait(longest)

    def retreat(self) -> Iterator[None]:
        """After a failure: what was approaching withdraws, what holds nothing any more lets go, all else stays."""
        self.clock.running = False
        for guide, goal in self._approaching:
            guide.lead_by(fixed_reference(goal), self.t, MIN_FACING_TIME * self.unit)
        for pair in self.sets.pairs:
            if pair.kind == "robot-thing" and self._losses.is_unfelt(pair.second.entity):
                self.mode(self.t, self._contacts[pair].name, "off", 0.0)
                self.carried = tuple(thing for thing in self.carried if thing != pair.second.entity)
                point = self._point(pair)
                self.guides[point].lead_by(fixed_reference(self.measured(point)), self.t, 0.0)
        yield from self.wait(BACKING_OFF_TIME * self.unit)

    def check(self) -> None:
        """Let go of what runs ahead while it is pushed, and push it again when its path has caught up.

        Raises:
            GivenUpError: A thing that was carried is lost.
        """
        if lost := self._losses.loss(self.t, self.carried, self.sets.pairs, self._loads):
            raise GivenUpError(lost)
        ramp = LOAD_RAMP * self.unit
        for contact in self._pushes.lead(self.tick, self.sets.pairs, self.is_felt):
            if contact.mode == "off":
                self.mode(self.t, contact.name, "fixed", ramp)
            else:
                self.mode(self.t + ramp, contact.name, "off", ramp)

    def _lead_over_supports(self, sets: ContactSets) -> None:
        """Lead the centre of mass over the middle of the supports, Otani (9)."""
        contacts = [self._contacts[pair] for pair in sets.pairs if pair.kind == "robot-world"]
        places = [self.tick.frame(contact.point).floor_projection(contact.vertices) for contact in contacts]
        self.lead_com(support_centre(np.vstack(places)))

    def _follow_com(self) -> None:
        """Let the centre of mass be among the supports as the human's is, Otani (33)."""
        path = self.demonstration.com[self.sets.supports]
        self.com.lead_by(self.clock.vector(path), self.t, COM_TIME * self.unit)

    def _take_sets(self) -> None:
        self.sets = self.demonstration.contacts.sets_after(self._happened, self._tracked)
        self.history.append((self.t, self.sets))

    def _gap(self, event: ContactEvent) -> float:
        """Distance of what makes a contact from where it should touch [m]; negative beyond."""
        target = self.demonstration.targets[event]
        return target.gap(self._body(target), self.measured(target.mover))

    def _mover(self, event: ContactEvent) -> PoseGuide:
        """Reference of what makes the contact of an event."""
        name = self._point(event.pair)
        return self.guides[name] if name in self.guides else self.things[name]

    def _point(self, pair: SurfacePair) -> str:
        name = self.demonstration.surface(pair.first).point
        assert name is not None
        return name

    def _body(self, target: Target) -> pin.SE3:
        """Where the body is that a contact is made with."""
        return pin.SE3.Identity() if target.body is None else self.measured(target.body)
