"""A human's centre of mass, from its points and the usual shares of the body's mass."""

import numpy as np
from numpy.typing import NDArray

from sot.motion.human.human import SIDES, Human

Array = NDArray[np.float64]

# Share of the mass, and how far from the first point to the second the segment's centre lies: Winter, Biomechanics and
# Motor Control of Human Movement, table 4.1; forearm and hand are one, and so are shank and foot.
_MIDDLE_SEGMENTS = (("waist", "neck", 0.497, 0.50), ("neck", "head_top", 0.081, 0.50))
_LIMB_SEGMENTS = (
    ("shoulder", "elbow", 0.028, 0.436),
    ("elbow", "wrist", 0.022, 0.682),
    ("hip", "knee", 0.100, 0.433),
    ("knee", "ankle", 0.061, 0.606),
)


def human_com(human: Human) -> Array:
    """Centre of mass over time (T, 3) [m]."""
    segments = list(_MIDDLE_SEGMENTS)
    for near, far, share, along in _LIMB_SEGMENTS:
        segments += [(f"{side}_{near}", f"{side}_{far}", share, along) for side in SIDES]
    total = sum(share for _, _, share, _ in segments)
    com = np.zeros((human.count, 3))
    for near, far, share, along in segments:
        com += share / total * ((1.0 - along) * human.points[near] + along * human.points[far])
    return com
