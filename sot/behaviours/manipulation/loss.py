"""Notices that a thing that is carried is lost."""

from collections.abc import Collection, Mapping

from sot.control.contact import Contact
from sot.motion.objects.events import SurfacePair


class LossWatch:
    """Notes since when nothing is felt on a thing that is carried; a hand may rest on what a hinge holds.

    Args:
        contacts: Of the pairs of a demonstration.
        patience: Time without any force on all that hold a thing, after which it is lost [s].
    """

    def __init__(self, contacts: Mapping[SurfacePair, Contact], patience: float) -> None:
        self._contacts, self._patience = contacts, patience
        self._unfelt_since: dict[str, float] = {}

    def is_unfelt(self, thing: str) -> bool:
        """Whether nothing is felt on a thing now."""
        return thing in self._unfelt_since

    def loss(
        self, t: float, carried: Collection[str], made: Collection[SurfacePair], loads: Mapping[str, float]
    ) -> str:
        """What was lost, when and by what, in words; empty if nothing was.

        Args:
            t: Time [s].
            carried: Things.
            made: Pairs that the demonstration has in touch now.
            loads: Measured normal forces, by the contacts' names [N].
        """
        for thing in carried:
            pairs = [pair for pair in made if pair.kind == "robot-thing" and pair.second.entity == thing]
            ramping = any(self._contacts[pair].load < 1.0 for pair in pairs)
            if ramping or not pairs or any(loads.get(self._contacts[pair].name, 0.0) > 0.0 for pair in pairs):
                self._unfelt_since.pop(thing, None)
            elif t - self._unfelt_since.setdefault(thing, t) > self._patience:
                held = ", ".join(sorted(pair.first.surface for pair in pairs))
                return f"{thing} was lost at {self._unfelt_since[thing]:.2f} s: nothing is felt at {held}"
        return ""
