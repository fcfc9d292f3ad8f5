"""The schedule of contacts for steps that are decided while the robot moves."""

from collections import deque
from collections.abc import Mapping

import numpy as np

from sot.behaviours.recovery import CHECK_INTERVAL, RecoverySchedule
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.live.steps.footing import SteppingFooting
from sot.motion.trajectory import Reference
from sot.robots.robot import Robot


class LiveSteppingSchedule(RecoverySchedule):
    """Leads the contacts through the steps that a footing begins, and catches a disturbed robot, as `RecoverySchedule`
    does. The footing waits with what comes next for a foot that is late, and for a robot that is off its plan.

    Args:
        robot: The robot.
        reference: What it does.
        footing: Its feet.
        ramp: As for `SteppingSchedule`.
    """

    def __init__(self, robot: Robot, reference: Reference, footing: SteppingFooting, ramp: float = 0.04) -> None:
        swings = {foot: footing.swing_path(foot) for foot in robot.feet}
        super().__init__(robot, reference, footing.phases(float("inf")), swings, ramp)
        self._footing = footing
        self._begun: deque[tuple[str, float, float]] = deque()
        self._looked_at = -np.inf
        footing.begun.append(lambda *step: self._begun.append(step))

    def observe(self, tick: Tick) -> None:
        """As `RecoverySchedule`; the footing is told which feet do not stand, and whether the robot is off its plan."""
        super().observe(tick)
        self._footing.aloft = {contact.point for contact in tick.contacts if contact.mode == "off"}
        if self._checked_at < tick.t and not 0.0 < tick.t - self._looked_at < CHECK_INTERVAL:  # one look a tick
            self._looked_at = tick.t
            self._footing.is_disturbed = self.is_disturbed(tick, self._footing.is_disturbed)

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """As `RecoverySchedule`, with the steps that have been begun since."""
        while self._begun:
            self.add_step(*self._begun.popleft())
        return super().apply(t, stack, loads)
