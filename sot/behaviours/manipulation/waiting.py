"""A schedule of steps, one a tick, each of which goes on until the robot is ready: what all that touch things share."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np
import pinocchio as pin

from sot.behaviours.manipulation.guide import PlaneGuide, fixed_place
from sot.behaviours.manipulation.pace import (
    COM_REST_SPEED,
    COM_SPEED,
    COM_TIME,
    COM_TOLERANCE,
    HOLDING_TIME,
    LOAD_RAMP,
    MAX_WAIT,
    TOUCH_LOAD,
)
from sot.control.contact import Contact
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = np.ndarray


class GivenUpError(Exception):
    """A step that has not ended as it should, in words."""


class WaitingSchedule(Schedule):
    """Leads a robot from contact to contact by steps that wait: for a touch, for a load, for the centre of mass.

    A subclass has its steps in `phases`, a generator that yields once a tick, and those after a failure in `retreat`.
    Both are made of the steps here.

    Args:
        robot: Who moves.
        com: Where the centre of mass is at the start (2,) [m].
        shift_time: See `PlaneGuide`, in √(leg / g).

    Attributes:
        leg, weight, unit: The robot's leg length [m], its weight [N] and √(leg / g) [s].
        com: Reference of the centre of mass.
        carried: Things whose mass counts in the centre of mass now.
        failure: Why what was planned was given up; empty while it is not.
        finished: Whether the run is over.
        t: The present time [s].
    """

    def __init__(self, robot: Robot, com: Array, shift_time: float) -> None:
        super().__init__()
        self.leg, self.weight = leg_length(robot), robot.mass * GRAVITY
        self.unit = float(np.sqrt(self.leg / GRAVITY))
        self.com = PlaneGuide(fixed_place(com), shift_time * self.unit)
        self.carried: tuple[str, ...] = ()
        self.failure, self.finished = "", False
        self.t = 0.0
        self._loads = dict[str, float]()
        self._tick: Tick | None = None
        self._owner_changed = False
        self._steps: Iterator[None] = self._until_finished(self.phases())

    def phases(self) -> Iterator[None]:
        """All steps."""
        raise NotImplementedError

    def retreat(self) -> Iterator[None]:
        """What is done after a step was given up."""
        raise NotImplementedError

    def check(self) -> None:
        """Look, before each step, at what ends all.

        Raises:
            GivenUpError: Something has gone wrong.
        """

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out what is due; returns it in words. Loads are the measured normal forces by the contacts' names."""
        done = super().apply(t, stack, loads)
        self.t, self._loads = t, dict(loads or {})
        if self._tick is None:
            return done
        try:
            if not self.failure:
                self.check()
            next(self._steps)
        except GivenUpError as error:
            self._steps = self._until_finished(iter(()) if self.failure else self.retreat())
            self.failure = self.failure or self.told(error)
            done.append(self.failure)
        if stack.carried != [*self.carried]:
            stack.carried, self._owner_changed = [*self.carried], True
        return done

    def told(self, error: GivenUpError) -> str:
        """Why all was given up, in words."""
        return str(error)

    def observe(self, tick: Tick) -> None:
        """Note the state; the centre of mass that is led changes its owner here."""
        self._tick = tick
        if self._owner_changed:
            self.com.restart(tick.com[:2].copy(), tick.com_velocity[:2].copy(), tick.t, COM_TIME * self.unit)
            self._owner_changed = False

    @property
    def tick(self) -> Tick:
        """The last state."""
        assert self._tick is not None
        return self._tick

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

    def take_load(self, *contacts: Contact) -> Iterator[None]:
        """Contacts that are felt take their load."""
        ramp = LOAD_RAMP * self.unit
        for contact in contacts:
            self.mode(self.t, contact.name, "fixed", ramp)
        yield from self.wait(ramp + HOLDING_TIME * self.unit)

    def give_load(self, *contacts: Contact) -> Iterator[None]:
        """Contacts give their load away, and are off."""
        ramp = LOAD_RAMP * self.unit
        for contact in contacts:
            self.mode(self.t + ramp, contact.name, "off", ramp)
        yield from self.wait(ramp)

    def lead_com(self, goal: Array) -> None:
        """Begin to lead the centre of mass to a place (2,)."""
        way = float(np.linalg.norm(goal - self.com(self.t)[0][:2]))
        self.com.lead_by(fixed_place(goal), self.t, self.unit * max(COM_TIME, way / (COM_SPEED * self.leg)))

    def settled_com(self, what_for: str = "") -> Iterator[None]:
        """Wait until the centre of mass is where it is led, at rest.

        Args:
            what_for: In words, for who reads why it was given up.

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
                where = f"the centre of mass is {1e3 * off:.0f} mm off its goal after {self.t - begun:.1f} s"
                raise GivenUpError(f"{what_for}: {where}" if what_for else where)
            yield

    def wait(self, duration: float) -> Iterator[None]:
        """Wait for a time [s]."""
        begun = self.t
        yield from self.until(lambda: self.t >= begun + duration - 1e-9)

    def until(self, condition: Callable[[], bool]) -> Iterator[None]:
        """Wait for a condition."""
        while not condition():
            yield

    def _until_finished(self, steps: Iterator[None]) -> Iterator[None]:
        yield from steps
        self.finished = True
        while True:
            yield
