"""A schedule of phases, each of which ends when the robot is ready: moves, touches, loads and waits as steps."""

from collections.abc import Iterator, Mapping

import numpy as np
import pinocchio as pin

from sot.behaviours.manipulation.guide import (
    PoseGuide,
    closing_reference,
    fixed_reference,
    placement_of,
)
from sot.behaviours.manipulation.hand_support import HandSupport
from sot.behaviours.manipulation.pace import (
    CLOSING_PATIENCE,
    CLOSING_RAMP,
    CLOSING_SPEED,
    LOAD_RAMP,
)
from sot.behaviours.manipulation.posture_guide import PostureGuide
from sot.behaviours.manipulation.waiting import GivenUpError, WaitingSchedule
from sot.control.contact import Contact
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.robots.robot import Robot

Array = np.ndarray

# Times are in √(leg / g), a quarter of a second for a robot of human size; lengths in leg lengths.
MOVING_SPEED = 0.1  # leg lengths per √(leg/g), mean
TURNING_SPEED = 0.2  # rad per √(leg/g), mean
MIN_MOVING_TIME = 1.6  # √(leg/g)


class PhasedSchedule(WaitingSchedule):
    """Leads points and the centre of mass through phases, one step a tick.

    Args:
        robot: Who moves.
        places: Where each point that is led is at the start.
        com: Where the centre of mass is (2,) [m].
        longest: Time in which all must be done [s].

    Attributes:
        guides: Reference of each point.
        posture: Reference of the joints.
        supports: Hands that support now.
        history: When each phase began, and its name.
    """

    def __init__(self, robot: Robot, places: Mapping[str, pin.SE3], com: Array, longest: float) -> None:
        super().__init__(robot, com, 1.0)
        self.guides = {point: PoseGuide(fixed_reference(place)) for point, place in places.items()}
        self.posture = PostureGuide(robot.rest[7:])
        self.supports: list[HandSupport] = []
        self.history: list[tuple[float, str]] = []
        self.led: list[Array] = []
        """Position, velocity and acceleration (3, 2) of the led centre of mass, tick by tick."""
        self.extra_time = longest

    def check(self) -> None:
        """Look at the hands that support.

        Raises:
            GivenUpError: One slips.
        """
        for support in self.supports:
            if support.is_given_up:
                raise GivenUpError(f"{support.contact.name} slipped {support.slips} times")

    def told(self, error: GivenUpError) -> str:
        """Why all was given up, and when."""
        return f"{error}, at {self.t:.1f} s"

    def observe(self, tick: Tick) -> None:
        """Note the state."""
        super().observe(tick)
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

    def phase(self, name: str) -> None:
        """Note that a phase begins."""
        self.history.append((self.t, name))

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
