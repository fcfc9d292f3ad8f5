"""Compiled functions, for what a tick does a thousand times a second on small arrays."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

_FASTMATH_FLAGS = {"reassoc", "contract", "nsz", "arcp"}
"""Sums may be reordered, which makes them vector instructions; infinities and nan keep their meaning."""


def compiled(function: F) -> F:
    """Compile a function on its first call, once an installation."""
    return cast(F, njit(cache=True, error_model="numpy", fastmath=_FASTMATH_FLAGS)(function))
