"""The schedule of contacts for steps that are decided while the robot moves."""

from collections import deque
from collections.abc import Mapping

from sot.behaviours.stepping import SteppingSchedule
from sot.control.stack import Stack
from sot.live.steps.footing import SteppingFooting
from sot.robots.robot import Robot


class LiveSteppingSchedule(SteppingSchedule):
    """Leads the contacts through the steps that a footing begins, by the measured loads, as `SteppingSchedule` does.

    Args:
        robot: The robot.
        footing: Its feet.
        ramp: As for `SteppingSchedule`.
    """

    def __init__(self, robot: Robot, footing: SteppingFooting, ramp: float = 0.04) -> None:
        super().__init__(robot, footing.phases(float("inf")), ramp)
        self._begun: deque[tuple[str, float, float]] = deque()
        footing.begun.append(lambda *step: self._begun.append(step))

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """As `SteppingSchedule`, with the steps that have been begun since."""
        while self._begun:
            self.add_step(*self._begun.popleft())
        return super().apply(t, stack, loads)
