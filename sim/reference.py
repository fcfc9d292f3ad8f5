"""A fixed computation, timed, so that times of several machines compare as ratios."""

from time import perf_counter

import numpy as np
from threadpoolctl import threadpool_limits

MATRIX_SHAPE = (62, 18)
HOT_RUNS = 200


class Reference:
    """The complete QR factorisation of a 62 × 18 matrix in numpy: about the size of a tick's matrices.

    Attributes:
        times_us: what each call took [µs].
    """

    def __init__(self) -> None:
        self.times_us: list[float] = []
        self._matrix = np.random.default_rng(0).normal(size=MATRIX_SHAPE)

    def __call__(self) -> None:
        """Compute it once, and note the time."""
        start = perf_counter()
        np.linalg.qr(self._matrix, mode="complete")
        self.times_us.append(1e6 * (perf_counter() - start))

    @property
    def median_us(self) -> float | None:
        """Median of the calls so far [µs]."""
        return float(np.median(self.times_us)) if self.times_us else None


def hot_reference_us() -> float:
    """Median time of the computation [µs] in a tight loop on one thread, with all that it touches in the caches."""
    reference = Reference()
    with threadpool_limits(1):
        for _ in range(HOT_RUNS):
            reference()
    return float(np.median(reference.times_us))
