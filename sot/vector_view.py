"""Arrays over Pinocchio's memory: over many of its arrays at once, and such that keep it alive."""

from collections.abc import Sequence

import numpy as np

Array = np.ndarray


def view_of_all(views: Sequence[Array], shape: tuple[int, ...]) -> Array:
    """One view (n, ...) of n arrays of a shape that lie in memory at equal intervals: members of a vector's elements.

    What is written to one of them shows in the view. To ask Pinocchio for each takes longer than to compute with all.
    """
    if len(views) < 2:
        return np.array(views).reshape(-1, *shape) if not views else views[0][None]
    first, *others = (view.__array_interface__["data"][0] for view in views)
    interval = others[0] - first
    assert others == [first + (k + 1) * interval for k in range(len(others))]
    return np.lib.stride_tricks.as_strided(views[0], (len(views), *shape), (interval, *views[0].strides))


def owned_view(view: Array, owner: object) -> Array:
    """The same view, which keeps alive what owns its memory, as Pinocchio's do not."""
    return np.asarray(_Owned(view, owner))


class _Owned:
    """What an array is made of: the memory of a view, and what it belongs to."""

    def __init__(self, view: Array, owner: object) -> None:
        self.__array_interface__ = view.__array_interface__
        self._owner = owner
