"""A schedule of phases, each of which ends when the robot is ready: moves, touches, loads and waits as steps."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np
import pinocchio as pin

from sot.behaviours.manipulation.guide import (
    PlaneGuide,
    PoseGuide,
    closing_reference,
    fixed_place,
    fixed_reference,
    placement_of,
)
from sot.behaviours.manipulation.hand_support import HandSupport
from sot.behaviours.manipulation.pace import (
    CLOSING_PATIENCE,
    CLOSING_RAMP,
    CLOSING_SPEED,
    COM_REST_SPEED,
    COM_SPEED,
    COM_TIME,
    COM_TOLERANCE,
    HOLDING_TIME,
    LOAD_RAMP,
    MAX_WAIT,
    TOUCH_LOAD,
)
from sot.behaviours.manipulation.posture_guide import PostureGuide
from sot.control.contact import Contact
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = np.ndarray

# Times are in √(leg / g), a quarter of a second for a robot of human size; lengths in leg lengths.
MOVING_SPEED = 0.1  # leg lengths per √(leg/g), mean
TURNING_SPEED = 0.2  # rad per √(leg/g), mean
MIN_MOVING_TIME = 1.6  # √(leg/g)


class GivenUpError(Exception):
    """A phase that has not ended as it should, in words."""


class PhasedSchedule(Schedule):
    """Leads points and the centre of mass through phases, one step a tick.

    A subclass has its phases in `phases`, a generator that yields once a tick, and what is done after a phase was given
    up in `retreat`. Both are made of the steps here.

    Args:
        robot: Who moves.
        places: Where each point that is led is at the start.
        com: Where the centre of mass is (2,) [m].
        longest: Time in which all must be done [s].

    Attributes:
        guides: Reference of each point.
        com: Reference of the centre of mass.
        posture: Reference of the joints.
        carried: Things whose mass counts in the centre of mass now.
        supports: Hands that support now.
        history: When each phase began, and its name.
    """

    def __init__(self, robot: Robot, places: Mapping[str, pin.SE3], com: Array, longest: float) -> None:
        super().__init__()
        self.leg, self.weight = leg_length(robot), robot.mass * GRAVITY
        self.unit = float(np.sqrt(self.leg / GRAVITY))
        self.guides = {point: PoseGuide(fixed_reference(place)) for point, place in places.items()}
        self.com = PlaneGuide(fixed_place(com), self.unit)
        self.posture = PostureGuide(robot.rest[7:])
        self.carried: tuple[str, ...] = ()
        self.supports: list[HandSupport] = []
        self.history: list[tuple[float, str]] = []
        self.led: list[Array] = []
        """Position, velocity and acceleration (3, 2) of the led centre of mass, tick by tick."""
        self.extra_time, self.failure, self.finished = longest, "", False
        self.t, self._loads = 0.0, dict[str, float]()
        self._tick: Tick | None = None
        self._owner_changed = False
        self._steps: Iterator[None] | None = None

    def phases(self) -> Iterator[None]:
        """All phases."""
        raise NotImplementedError

    def retreat(self) -> Iterator[None]:
        """What is done after a phase was given up."""
        raise NotImplementedError

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out what is due; returns it in words. Loads are the measured normal forces by the contacts' names."""
        done = super().apply(t, stack, loads)
        self.t, self._loads = t, dict(loads or {})
        if self._tick is None:
            return done
        self._steps = self._steps or self._all()
        try:
            for support in self.supports:
                if support.is_given_up and not self.failure:
                    raise GivenUpError(f"{support.contact.name} slipped {support.slips} times")
            next(self._steps)
        except GivenUpError as error:
            self._steps = self._ending(iter(()) if self.failure else self.retreat())
            self.failure = self.failure or f"{error}, at {t:.1f} s"
            done.append(self.failure)
        if stack.carried != [*self.carried]:
            stack.carried, self._owner_changed = [*self.carried], True
        return done

    def observe(self, tick: Tick) -> None:
        """Note the state; the centre of mass that is led changes its owner here."""
        self._tick = tick
        if self._owner_changed:
            self.com.restart(tick.com[:2].copy(), tick.com_velocity[:2].copy(), tick.t, COM_TIME * self.unit)
            self._owner_changed = False
        self.posture.observe(tick)
        for support in self.supports:
            support.observe(tick)
        self.led.append(np.array([part[:2] for part in self.com(tick.t)]))

    def motion_time(self, t: float) -> float:
        """The reference stands still."""
        return 0.0

    def balance(self, t: float) -> tuple[Array, Array, Array, Array]:
        """Reference of `tasks.Balance`: the led centre of mass, and the zero-moment point that goes with it."""
        place, velocity, acceleration = self.com(t)
        return place, velocity, acceleration, self.zmp_of(place[:2], acceleration[:2])

    def zmp_of(self, place: Array, acceleration: Array) -> Array:
        """Zero-moment point (2,) of a centre of mass (2,) at its present height, of a robot on the floor."""
        height = self._tick.com[2] if self._tick is not None else self.leg
        zmp: Array = place - height / GRAVITY * acceleration
        return zmp

    @property
    def tick(self) -> Tick:
        """The last state."""
        assert self._tick is not None
        return self._tick

    def phase(self, name: str) -> None:
        """Note that a phase begins."""
        self.history.append((self.t, name))

    def measured(self, point: str) -> pin.SE3:
        """Where a point of the robot or a thing is."""
        frame = self.tick.frame(point)
        return pin.SE3(frame.rotation.copy(), frame.position.copy())

    def force(self, contact: Contact) -> float:
        """Measured normal force of a contact [N]."""
        return self._loads.get(contact.name, 0.0)

    def is_felt(self, contact: Contact) -> bool:
        """Whether a contact's surfaces touch, by the measured normal force."""
        return self.force(contact) > TOUCH_LOAD * self.weight

    def lead_through(self, point: str, *goals: pin.SE3) -> Iterator[None]:
        """Lead a point to one goal after the other."""
        for goal in goals:
            yield from self.wait(self.lead(point, goal))

    def lead(self, point: str, goal: pin.SE3) -> float:
        """Begin to lead a point to a goal; returns how long that takes [s]."""
        guide = self.guides[point]
        now = placement_of(guide(self.t))
        way = float(np.linalg.norm(goal.translation - now.translation)) / self.leg / MOVING_SPEED
        turn = float(np.linalg.norm(pin.log3(now.rotation.T @ goal.rotation))) / TURNING_SPEED
        duration = self.unit * max(MIN_MOVING_TIME, way, turn)
        guide.lead_by(fixed_reference(goal), self.t, duration)
        return duration

    def touch(self, point: str, contact: Contact, direction: Array, farthest: float) -> Iterator[None]:
        """Lead a point on in a direction (3,) until its contact is felt.

        Raises:
            GivenUpError: Nothing is felt on this way [m].
        """
        guide, speed, ramp = self.guides[point], CLOSING_SPEED * self.leg / self.unit, CLOSING_RAMP * self.unit
        start, begun = placement_of(guide(self.t)), self.t
        guide.lead_by(closing_reference(start, speed * direction, self.t, ramp), self.t, 0.0)
        while not self.is_felt(contact):
            way = float((self.measured(point).translation - start.translation) @ direction)
            if way > farthest or self.t - begun > CLOSING_PATIENCE * (farthest / speed + ramp):
                guide.lead_by(fixed_reference(start), self.t, MIN_MOVING_TIME * self.unit)
                raise GivenUpError(f"{contact.name}: no touch within {self.t - begun:.1f} s of closing in")
            yield
        guide.lead_by(fixed_reference(placement_of(guide(self.t))), self.t, 0.0)

    def take_load(self, contact: Contact) -> Iterator[None]:
        """A contact that is felt takes its load."""
        ramp = LOAD_RAMP * self.unit
        self.mode(self.t, contact.name, "fixed", ramp)
        yield from self.wait(ramp + HOLDING_TIME * self.unit)

    def give_load(self, contact: Contact) -> Iterator[None]:
        """A contact gives its load away, and is off."""
        ramp = LOAD_RAMP * self.unit
        self.mode(self.t + ramp, contact.name, "off", ramp)
        yield from self.wait(ramp)

    def support_by(self, hand: HandSupport, arm: Array) -> Iterator[None]:
        """A hand that has touched supports: first by a fraction of what it may, and by all once it carries that.

        Args:
            hand: The hand.
            arm: Numbers of the joints of its arm, which yield from now on.

        Raises:
            GivenUpError: It carries nothing.
        """
        hand.settle(self.tick)
        self.supports.append(hand)
        self.posture.let_yield(arm)
        yield from self.take_load(hand.contact)
        if not hand.carries(self.force(hand.contact)):
            raise GivenUpError(f"{hand.contact.name} carries {self.force(hand.contact):.0f} N only")
        yield from self.trust(hand, 0.0, 1.0)

    def trust(self, hand: HandSupport, first: float, last: float) -> Iterator[None]:
        """What a hand may bear changes from one share of it to another, of what is above its probing share."""
        begun, ramp = self.t, LOAD_RAMP * self.unit
        while self.t < begun + ramp:
            hand.trust(first + (last - first) * (self.t - begun) / ramp)
            yield
        hand.trust(last)

    def release(self, hand: HandSupport, arm: Array) -> Iterator[None]:
        """A hand gives its load away and supports no longer; its arm's joints are led into the posture again."""
        yield from self.give_load(hand.contact)
        self.supports.remove(hand)
        self.posture.lead_back(arm, self.t, 2.0 * LOAD_RAMP * self.unit)

    def lead_com(self, goal: Array) -> None:
        """Begin to lead the centre of mass to a place (2,)."""
        way = float(np.linalg.norm(goal - self.com(self.t)[0][:2]))
        self.com.lead_by(fixed_place(goal), self.t, self.unit * max(COM_TIME, way / (COM_SPEED * self.leg)))

    def settled_com(self) -> Iterator[None]:
        """Wait until the centre of mass is where it is led, at rest.

        Raises:
            GivenUpError: It does not get there in time.
        """
        begun, calm = self.t, 0
        while calm < 2 or self._owner_changed:
            off = float(np.linalg.norm(self.tick.com[:2] - self.com(self.t)[0][:2]))
            still = float(np.linalg.norm(self.tick.com_velocity[:2])) < COM_REST_SPEED * self.leg / self.unit
            arrived = self.com.arrives_at <= self.t and off < COM_TOLERANCE * self.leg
            calm = calm + 1 if still and arrived else 0
            if self.t - begun > MAX_WAIT * self.unit:
                raise GivenUpError(f"the centre of mass is {1e3 * off:.0f} mm off its goal")
            yield

    def wait(self, duration: float) -> Iterator[None]:
        """Wait for a time [s]."""
        begun = self.t
        yield from self.until(lambda: self.t >= begun + duration - 1e-9)

    def until(self, condition: Callable[[], bool]) -> Iterator[None]:
        """Wait for a condition."""
        while not condition():
            yield

    def _all(self) -> Iterator[None]:
        return self._ending(self.phases())

    def _ending(self, steps: Iterator[None]) -> Iterator[None]:
        yield from steps
        self.finished = True
        while True:
            yield
