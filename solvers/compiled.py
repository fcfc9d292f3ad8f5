"""A decorator that compiles functions on small arrays, which a tick calls a thousand times a second."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

_FASTMATH_FLAGS = {"reassoc", "contract", "nsz", "arcp"}
"""Sums may be reordered, which makes them vector instructions; infinities and nan keep their meaning."""


def compiled(function: F) -> F:
    """Compile a function at its first call; the result is cached on disk."""
    return cast(F, njit(cache=True, error_model="numpy", fastmath=_FASTMATH_FLAGS)(function))
