"""Hands that push let go of what runs ahead of its path: a push cannot hold it back, and its own joint brakes it."""

from collections.abc import Callable, Collection, Mapping

import numpy as np

from sot.control.contact import Contact
from sot.control.pose import PoseReference
from sot.control.tick import Tick
from sot.motion.objects.events import SurfacePair

MAX_LEAD = 0.01
"""Distance by which a pushed surface may be ahead of its path before the hand lets go of it [leg lengths]."""


class Pushes:
    """The contacts of hands with things that hang on joints, made and broken as the things need to be pushed.

    A hand that stays on such a thing leans on it, however lightly, and that keeps going what next to nothing brakes. A
    hand that has let go is led on along the thing's path; it takes load again when the path has caught up.

    Args:
        contacts: Of the pairs of a demonstration.
        paths: Of the things: where they are meant to be at a time [s].
        pushed: Names of the things that are pushed.
        leg: The robot's leg length [m].
    """

    def __init__(
        self,
        contacts: Mapping[SurfacePair, Contact],
        paths: Mapping[str, PoseReference],
        pushed: Collection[str],
        leg: float,
    ) -> None:
        self._contacts = {
            pair: contact
            for pair, contact in contacts.items()
            if pair.kind == "robot-thing" and pair.second.entity in pushed
        }
        self._paths, self._max_lead = paths, MAX_LEAD * leg

    def lead(self, tick: Tick, made: Collection[SurfacePair], felt: Callable[[Contact], bool]) -> list[Contact]:
        """The contacts that are to change from made to let go, or back.

        Args:
            tick: The state.
            made: Pairs that the demonstration has in touch now.
            felt: Whether a force is felt at a contact.
        """
        return [
            contact
            for pair, contact in self._contacts.items()
            if pair in made and self._changes(tick, pair.second.entity, contact, felt)
        ]

    def _changes(self, tick: Tick, thing: str, contact: Contact, felt: Callable[[Contact], bool]) -> bool:
        if contact.mode == "off":
            return felt(contact) and self._lead(tick, thing, contact) < self._max_lead
        return contact.load >= 1.0 and self._lead(tick, thing, contact) > self._max_lead

    def _lead(self, tick: Tick, thing: str, contact: Contact) -> float:
        """Distance by which a thing's surface is ahead of its path where the hand is, away from the hand [m]."""
        body, path = tick.frame(thing), self._paths[thing](tick.t)
        spot = contact.motion(tick).position
        planned = path.position + path.rotation @ (body.rotation.T @ (spot - body.position))
        return float(np.dot(planned - spot, tick.surface_axes(contact.on).rotation[:, 2]))
