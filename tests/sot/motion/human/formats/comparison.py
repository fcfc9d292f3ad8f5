"""A human read from another format against the same human from the shipped clip."""

from pathlib import Path

import numpy as np

from sot.motion import Human, read, recognise
from sot.motion.likeness import segment_angles
from tests.sot.motion.human.clips import short_groove

FRAMES, FIRST = 60, 150


def dancing_human(folder: Path) -> Human:
    """The human in the same frames as `dance.dance`, from the clip as it ships."""
    path = folder / "groove.bvh"
    path.write_text(short_groove(FRAMES, FIRST))
    return recognise(read(path))


def largest_angle(expected: Human, human: Human, *segments: str) -> float:
    """Between the same segments of two humans, of all unless some are named, at any time [deg]."""
    angles = segment_angles(expected.points, human.points)
    return float(np.degrees(max(angles[name].max() for name in segments or angles)))
