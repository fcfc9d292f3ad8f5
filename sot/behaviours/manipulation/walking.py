"""Things carried on the robot's own steps: contacts of hands and things wait, and the feet step in between."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sot.behaviours.manipulation.schedule import ManipulationSchedule
from sot.behaviours.stepping import SteppingSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.gravity import GRAVITY
from sot.motion.feet.contacts import Phase
from sot.motion.objects.events import SurfacePair
from sot.motion.objects.retarget import RobotDemonstration
from sot.motion.trajectory import Motion

Array = np.ndarray


class WalkingManipulation(ManipulationSchedule):
    """A `ManipulationSchedule` whose feet step by the phases of the motion, on the demonstration's clock.

    The demonstration has no events of feet, and the clock is not stopped while one is in the air. The centre of mass of
    the motion is the one of robot and load while something is carried, and the robot's alone otherwise.

    Args:
        demonstration: What is to be done.
        contacts: Of the stack, see `ManipulationSchedule`; those of the feet are called as the feet are.
    """

    def __init__(self, demonstration: RobotDemonstration, contacts: Mapping[SurfacePair, Contact]) -> None:
        super().__init__(demonstration, contacts, com_shifted_by_hands=False)
        motion = demonstration.motion
        self._stepping, self._footholds = SteppingSchedule(motion.robot, motion.phases), motion.feet

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out what is due; returns it in words. Loads are the measured normal forces by the contacts' names."""
        self.clock.advance(t)
        done = self._stepping.apply(self.clock.time, stack, loads)  # first: the stack's time is the robot's afterwards
        return done + super().apply(t, stack, loads)

    def balance(self, t: float) -> tuple[Array, Array, Array, Array]:
        """Centre of mass, its velocity and acceleration (3,), and zero-moment point (2,) at the robot's present time.

        The zero-moment point is the one of the centre of mass as it is led, with the angular momentum of the motion.
        """
        com, velocity, acceleration = self.com(t)
        motion = self.demonstration.motion
        height, speed, lift, zmp = motion.balance(self.clock.time)
        pace, change = self.clock.rate, self.clock.acceleration
        pendulum = height[2] / (GRAVITY + lift[2])
        turning = zmp - height[:2] + pendulum * lift[:2]
        com[2], velocity[2], acceleration[2] = height[2], pace * speed[2], pace**2 * lift[2] + change * speed[2]
        return com, velocity, acceleration, com[:2] - pendulum * acceleration[:2] + pace**2 * turning

    def angular_momentum(self, t: float) -> Array:
        """Angular momentum of the motion at the robot's present time (3,) [N m s]."""
        return self.clock.rate * self.demonstration.motion.angular_momentum(self.clock.time)

    def foothold(self, foot: str, t: float) -> Array:
        """Where the motion has a foot stand at the robot's present time (3,) [m]."""
        place: Array = self._footholds[foot](self.clock.time)
        return place

    def played(self) -> Motion:
        """The motion as it was played, its steps at the times at which they were made."""
        played, clock = super().played(), self.played_times()
        motion = self.demonstration.motion
        phases, zmp = motion.phases, np.array([motion.balance(t)[3] for t in clock.tolist()])
        starts = [float(np.searchsorted(clock, phase.start)) / played.rate for phase in phases]
        ends = [*starts[1:], played.duration]
        stepped = tuple(
            Phase(start, end, phase.feet) for start, end, phase in zip(starts, ends, phases, strict=True) if end > start
        )
        return replace(played, phases=stepped, zmp=zmp)
