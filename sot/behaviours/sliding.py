"""Feet that slide: their contacts slide while the motion has them do so."""

from collections.abc import Sequence

from sot.control.schedule import Schedule
from sot.motion.feet.contacts import Phase


class SlidingSchedule(Schedule):
    """A schedule that lets the contacts of the feet slide, and stand again, as the phases of a motion say.

    Args:
        phases: of the motion, `Motion.phases`.
    """

    def __init__(self, phases: Sequence[Phase]) -> None:
        super().__init__()
        before: tuple[str, ...] = ()
        for phase in phases:
            for foot in phase.sliding:
                if foot not in before:
                    self.mode(phase.start, foot, "sliding")
            for foot in before:
                if foot not in phase.sliding:
                    self.mode(phase.start, foot, "fixed")
            before = phase.sliding
