"""A schedule for feet that step: it makes and breaks contacts by the plan and by the measured loads."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

from sot.control.contact import Contact
from sot.control.pose import PoseReference
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.gravity import GRAVITY
from sot.motion.feet.contacts import Phase
from sot.motion.feet.footfalls import Footfalls
from sot.robots.robot import Robot

TOUCHDOWN_LOAD_SHARE = 0.05  # share of the weight: a foot that measures this load has touched down
CARRYING_LOAD_SHARE = 0.3  # share of the weight that the other feet must carry before one is released
EARLIEST_LANDING_SHARE = 0.6  # share of a swing after which a measured load counts as touchdown
HEEL_RAMP_SHARE = 0.5  # of the load's ramp, in which a heel gives its load away before it rises
MAX_LANDING_DELAY = 0.15  # s, after the planned touchdown, in which a foot still looks for the floor


@dataclass(slots=True)
class _Foot:
    """A foot on its way through its stances.

    `next_stance` counts the stances begun; `landed_at` is the time of the last touchdown, `lifts_at` that of the next
    lift-off, once it is decided, and `heel_from` the time since when its heel gives its load away.
    """

    name: str
    stances: Footfalls
    next_stance: int
    landed_at: float
    lifts_at: float | None = None
    heel_from: float | None = None


class SteppingSchedule(Schedule):
    """A schedule that leads the contacts of the feet through the phases of a motion.

    - A foot gives its load away within `ramp` before it leaves the floor, and takes it within `ramp` after it is back.
    - Its heel rises before, if the phases say so, once another foot carries.
    - It is not released before another foot stands with all its load and feels some of the weight. If that comes too
      late the step is left out.
    - A swinging foot that feels the floor in the last part of its swing has landed. One that does not feel it in time
      is given a little longer, in which `tasks.SwingFoot` lowers it.

    Args:
        robot: The robot.
        phases: Of the motion, `Motion.phases`.
        ramp: How long a contact takes to give its load away, or to take it [s].
        heel_paths: Foot -> its path in the motion, along which its heel rises where `phases` say so; unless given, feet
            stay flat.
    """

    def __init__(
        self,
        robot: Robot,
        phases: Sequence[Phase],
        ramp: float = 0.04,
        heel_paths: Mapping[str, PoseReference] | None = None,
    ) -> None:
        super().__init__()
        self.ramp = ramp
        self._weight = robot.mass * GRAVITY
        falls = {foot: Footfalls(phases, foot) for foot in robot.feet}
        self._feet = [_Foot(name, stances, stances.count_begun(0.0), -ramp) for name, stances in falls.items()]
        self._heel_paths = dict(heel_paths or {})

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out the changes that are due and return them in words; without loads all happens as planned."""
        done = super().apply(t, stack, loads)
        for foot in self._feet:
            contact = stack.contact(foot.name)
            mode = contact.mode
            if mode == "fixed":
                self._update_standing(t, foot, contact, stack, loads)
            elif mode == "off":
                self._update_swinging(t, foot, contact, loads.get(foot.name, 0.0) if loads else None)
            if contact.mode != mode:
                done.append(f"{foot.name} {contact.mode}")
        return done

    def others_carry(self, foot: str, stack: Stack, loads: Mapping[str, float] | None) -> bool:
        """Whether another foot stands with all its load and, as far as loads are measured, carries enough weight."""
        standing = [
            other.name
            for other in self._feet
            if other.name != foot
            and stack.contact(other.name).mode == "fixed"
            and stack.contact(other.name).load >= 1.0
        ]
        if not standing or not loads:
            return bool(standing)
        return sum(loads.get(name, 0.0) for name in standing) >= CARRYING_LOAD_SHARE * self._weight

    def stances_begun(self, foot: str) -> int:
        """Number of stances of a foot that have begun."""
        return self._foot(foot).next_stance

    def stances_to_come(self, foot: str) -> int:
        """Number of stances of a foot that are still to come."""
        return len(self._foot(foot).stances) - self.stances_begun(foot)

    def next_lift(self) -> float:
        """When the next foot is to leave the floor of those that stand [s], infinite if none is."""
        leaves = [
            foot.stances[foot.next_stance - 1].end for foot in self._feet if 0 < foot.next_stance < len(foot.stances)
        ]
        return min(leaves, default=inf)

    def next_landing(self, foot: str) -> float:
        """When the next stance of a foot begins [s], infinite if none is to come."""
        own = self._foot(foot)
        return own.stances[own.next_stance].start if own.next_stance < len(own.stances) else inf

    def add_step(self, foot: str, lift: float, land: float) -> None:
        """Insert a step of a standing foot between two times [s]."""
        own = self._foot(foot)
        own.stances = own.stances.with_step(lift, land, own.stances[own.next_stance - 1].pose)

    def move_landing(self, foot: str, t: float) -> None:
        """Let the next stance of a foot begin at another time [s]."""
        own = self._foot(foot)
        own.stances = own.stances.with_landing(own.next_stance, t)

    def _foot(self, name: str) -> _Foot:
        return next(foot for foot in self._feet if foot.name == name)

    def _update_standing(
        self, t: float, foot: _Foot, contact: Contact, stack: Stack, loads: Mapping[str, float] | None
    ) -> None:
        """Ramp the load of a standing foot up, and down in time for the next swing."""
        contact.load = min(max((t - foot.landed_at) / self.ramp, 0.0), 1.0) if self.ramp else 1.0
        if foot.next_stance == 0 or foot.next_stance >= len(foot.stances):
            return
        stance, lands = foot.stances[foot.next_stance - 1], foot.stances[foot.next_stance].start
        leaves, path = stance.end, self._heel_paths.get(foot.name)
        if path is not None and stance.rises is not None and not contact.is_rolling:
            self._raise_heel(t, foot, contact, path, stack, loads)
        if foot.lifts_at is None and t >= leaves - self.ramp - 1e-9:
            if contact.load >= 1.0 and self.others_carry(foot.name, stack, loads):
                foot.lifts_at = max(leaves, t + self.ramp)
            elif t > leaves + EARLIEST_LANDING_SHARE * (lands - leaves):
                foot.next_stance += 1  # too late for this step
                contact.roll(None)
                foot.heel_from = None
        if foot.lifts_at is not None:
            contact.load = min(max((foot.lifts_at - t) / self.ramp, 0.0), 1.0) if self.ramp else 0.0
            if t >= foot.lifts_at - 1e-9:
                contact.mode, contact.load, foot.lifts_at = "off", 0.0, None

    def _raise_heel(
        self,
        t: float,
        foot: _Foot,
        contact: Contact,
        path: PoseReference,
        stack: Stack,
        loads: Mapping[str, float] | None,
    ) -> None:
        """Let a standing foot's heel give its load away while another foot stands, and roll once that one carries."""
        rises, time = foot.stances[foot.next_stance - 1].rises, HEEL_RAMP_SHARE * self.ramp
        others = [stack.contact(other.name).mode for other in self._feet if other is not foot]
        if rises is None or t < rises - time - 1e-9 or contact.load < 1.0 or "fixed" not in others:
            return
        if foot.heel_from is None:
            foot.heel_from = t
        contact.heel_load = min(max(1.0 - (t - foot.heel_from) / time, 0.0), 1.0) if time else 0.0
        if contact.heel_load <= 0.0 and t >= rises - 1e-9 and self.others_carry(foot.name, stack, loads):
            foot.heel_from = None
            contact.roll(path, t)

    def _update_swinging(self, t: float, foot: _Foot, contact: Contact, felt: float | None) -> None:
        """Land a swinging foot when it measures the floor, or when it is time."""
        if foot.next_stance >= len(foot.stances):
            return
        leaves = foot.stances[foot.next_stance - 1].end if foot.next_stance else 0.0
        lands = foot.stances[foot.next_stance].start
        touches = (
            felt is not None
            and felt > TOUCHDOWN_LOAD_SHARE * self._weight
            and t > leaves + EARLIEST_LANDING_SHARE * (lands - leaves)
        )
        due = t >= lands + (0.0 if felt is None else MAX_LANDING_DELAY) - 1e-9
        if touches or due:
            surface = foot.stances[foot.next_stance].surface
            if surface is not None:
                contact.move_to(surface)
            contact.mode, contact.load = "fixed", 0.0
            contact.roll(None)
            foot.landed_at, foot.next_stance, foot.heel_from = t, foot.next_stance + 1, None
