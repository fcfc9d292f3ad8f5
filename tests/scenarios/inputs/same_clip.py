"""Whether two clips are the same."""

import re

import numpy as np


def assert_same_clip(ours: str, theirs: str) -> None:
    """The same but for rounding, which may turn 180° into -180°."""
    (head, motion), (other_head, other) = (re.split(r"(?<=Frame Time: )", text) for text in (ours, theirs))
    assert head == other_head
    off = np.fromstring(motion, sep=" ") - np.fromstring(other, sep=" ")
    np.testing.assert_allclose((off + 180.0) % 360.0 - 180.0, 0.0, atol=2e-3)
