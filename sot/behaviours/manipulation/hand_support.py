"""A hand that supports: put down where a touch is felt, loaded only while it carries, given up if it slips."""

from dataclasses import replace

import numpy as np
import pinocchio as pin

from sot.control.contact import Contact
from sot.control.tick import Tick

Array = np.ndarray

MAX_SLIP = 0.008
"""Way along the surface beyond which a hand slips [leg lengths]."""
SLIPPING_FRICTION_SHARE = 0.5
"""Share of its friction that is relied upon from the first slip on."""
MAX_SLIPS = 2
"""Slips after which a hand is given up."""
MIN_CARRIED_SHARE = 0.5
"""Share of its least force that a hand must be felt to carry."""
PROBING_SHARE = 0.25
"""Share of its greatest force that a hand may bear before it has been felt to carry."""


class HandSupport:
    """What is known of a hand's contact with the world from forces and from the hand's own motion.

    The surface may be elsewhere than told, and more slippery: the contact is made with a surface where the touch was
    felt; it is loaded by a fraction until it carries that; friction that has failed is not relied upon again.

    Args:
        contact: Of the hand with a surface of the world; off. Its `least` and `most` bound what it is to carry.
        leg: The robot's leg length [m].

    Attributes:
        slips: How often it has slipped.
        slip: How far it has moved along the surface since the contact was made or last counted as a slip [m].
        height: How much higher than told the surface was found [m].
    """

    def __init__(self, contact: Contact, leg: float) -> None:
        self.contact, self.slips, self.slip, self.height = contact, 0, 0.0, 0.0
        self._most, self._friction, self._max_slip = contact.most, contact.friction, MAX_SLIP * leg
        self._place: Array | None = None

    def settle(self, tick: Tick) -> None:
        """Let the contact be with the surface where the hand has touched it."""
        contact, on = self.contact, self.contact.on
        axes = tick.surface_axes(contact.surface)
        self.height = float((axes.translation - on.axes.translation) @ on.axes.rotation[:, 2])
        shift = pin.SE3(np.eye(3), self.height * on.axes.rotation[:, 2])
        contact.move_to(replace(on, placement=shift * on.placement))
        contact.most, self._place = PROBING_SHARE * self._most, None

    def carries(self, force: float) -> bool:
        """Whether a measured normal force [N] is what the loaded contact bears at least."""
        return force >= MIN_CARRIED_SHARE * (self.contact.least or 0.0)

    def trust(self, share: float) -> None:
        """Let it bear a share of what it may, from the probing share on to all of it."""
        self.contact.most = (PROBING_SHARE + (1.0 - PROBING_SHARE) * share) * self._most

    def observe(self, tick: Tick) -> None:
        """Follow the hand while its contact is made; a slip lessens the friction that is relied upon."""
        if self.contact.mode != "fixed":
            self._place = None
            return
        place = self.contact.motion(tick).position
        if self._place is None:
            self._place = place.copy()
        self.slip = float(np.linalg.norm((place - self._place) @ self.contact.on.axes.rotation[:, :2]))
        if self.slip > self._max_slip:
            self.slips, self._place = self.slips + 1, place.copy()
            self.contact.rely_on(SLIPPING_FRICTION_SHARE * self._friction)

    @property
    def is_given_up(self) -> bool:
        """Whether it has slipped too often to be relied upon."""
        return self.slips >= MAX_SLIPS
