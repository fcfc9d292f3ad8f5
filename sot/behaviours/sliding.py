"""A schedule for feet that slide while the motion's phases say so."""

from collections.abc import Sequence

from sot.control.schedule import Schedule
from sot.motion.feet.contacts import Phase


class SlidingSchedule(Schedule):
    """Switches the contacts of the feet to sliding and back to standing, as the phases of a motion say.

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
