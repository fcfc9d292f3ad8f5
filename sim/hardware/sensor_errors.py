"""Errors of sensors: bias, lag, noise and rounding of a channel, reading by reading."""

from math import exp

import numpy as np

from sot.hardware.sensors import Channel

Array = np.ndarray


class ErrorModel:
    """The errors of one channel.

    Args:
        channel: their sizes.
        count: components of a reading.
        random: of signs and noise.
    """

    def __init__(self, channel: Channel, count: int, random: np.random.Generator) -> None:
        self._channel, self._random = channel, random
        self._bias = channel.bias * random.choice((-1.0, 1.0), count)
        self._filtered: Array | None = None
        self._ideal = channel == Channel()

    def lagged(self, value: Array, passed: float) -> Array:
        """A value (count,) behind the channel's filter, a time [s] after the last one; the first is its own past."""
        if not self._channel.lag or self._filtered is None:
            self._filtered = np.array(value)
        else:
            self._filtered = self._filtered + (1.0 - exp(-passed / self._channel.lag)) * (value - self._filtered)
        return self._filtered

    def errors(self) -> Array:
        """Bias and noise of the next reading (count,)."""
        return self._bias + self._channel.noise * self._random.standard_normal(len(self._bias))

    def __call__(self, value: Array, passed: float) -> Array:
        """A reading (count,) of a value, a time [s] after the last one."""
        if self._ideal:
            return np.array(value)
        reading = self.lagged(value, passed) + self.errors()
        step = self._channel.step
        return step * np.round(reading / step) if step else reading
