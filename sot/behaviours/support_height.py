"""How high the ground is that the feet stand on, and how fast a body over it tips."""

import numpy as np

from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.robots.surface import FLOOR

MIN_PENDULUM_HEIGHT = 0.1
"""Least height of the centre of mass over the ground that is reckoned with [m]."""


def support_height(tick: Tick) -> float:
    """Height of the surfaces of the world under the standing feet, their mean weighted by the load that each may take.

    On the floor, and while no foot stands, it is 0 [m].
    """
    total = height = 0.0
    for contact in tick.contacts:
        if contact.mode == "fixed" and contact.load > 0.0 and contact.is_footing and contact.point in tick.robot.feet:
            total += contact.load
            if contact.on is FLOOR:
                continue
            height += contact.load * float(contact.on.height_at(tick.frame(contact.point).position[:2]))
    return height / total if total else 0.0


def divergence_rate(tick: Tick) -> float:
    """Rate ω = √(g / h) at which the divergent component leaves [1/s], h the height over what the feet stand on."""
    return float(np.sqrt(GRAVITY / max(tick.com[2] - support_height(tick), MIN_PENDULUM_HEIGHT)))
