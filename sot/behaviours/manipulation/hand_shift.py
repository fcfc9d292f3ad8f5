"""How far hands that press on things shift the centre of mass."""

from collections.abc import Collection, Mapping

import numpy as np

from sot.control.contact import Contact
from sot.control.tick import Tick
from sot.motion.objects.events import SurfacePair
from sot.motion.objects.support import com_shift_of_hands

Array = np.ndarray


def shift_of_hands(
    tick: Tick, pairs: Collection[SurfacePair], contacts: Mapping[SurfacePair, Contact], loads: Mapping[str, float]
) -> Array:
    """Where the centre of mass has to be beside the supports' middle for the measured forces of hands, (2,) [m].

    Args:
        tick: The state.
        pairs: That touch; things whose mass counts as the robot's are left out, their forces are inner ones.
        contacts: Of these pairs.
        loads: Measured normal forces, by the contacts' names [N].
    """
    hands = [contacts[pair] for pair in pairs if pair.kind == "robot-thing"]
    feet = [contacts[pair] for pair in pairs if pair.kind == "robot-world"]
    if not hands or not feet:
        return np.zeros(2)
    forces, points = np.empty((len(hands), 3)), np.empty((len(hands), 3))
    for k, contact in enumerate(hands):
        # A hand that only bumps into something is not what the robot is to lean against.
        forces[k] = contact.load * loads.get(contact.name, 0.0) * tick.surface_axes(contact.on).rotation[:, 2]
        points[k] = tick.frame(contact.point).position
    middle = np.mean([tick.frame(contact.point).position for contact in feet], axis=0)
    return com_shift_of_hands(forces, points, middle, tick.mass)
