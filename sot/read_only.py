"""Arrays that nobody can write to."""

import numpy as np

Array = np.ndarray


def read_only(values: Array) -> Array:
    """A copy of numbers, in floating point, that is read-only."""
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
