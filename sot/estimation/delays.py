"""Readings without the delay of their filters, and what they will be by now."""

import numpy as np

Array = np.ndarray


class PromptReadings:
    """Measured quantities without the lag of their sensors, and their slopes.

    A filter of first order whose reading goes from y to y⁺ within h has been fed with

        x = y + (y⁺ − y) / (1 − e^{−h/τ}).

    White noise of readings becomes larger by that, but its integral does not.

    Args:
        lag: time constants τ (n,) of the sensors' filters [s]; 0 for none.

    Attributes:
        value: what the sensors were fed with at the readings' stamp (n,).
        slope: the change of that a second (n,), between the last two stamps; zero at first.
    """

    def __init__(self, lag: Array) -> None:
        with np.errstate(divide="ignore"):
            self._rate = 1.0 / lag
        self._reading: Array | None = None

    def update(self, reading: Array, passed: float) -> None:
        """Take in readings (n,), a time [s] after the last ones; the first are their own past."""
        if self._reading is None or not passed > 0.0:
            self.value, self.slope = reading, np.zeros(len(reading))
        else:
            value = self._reading - (reading - self._reading) / np.expm1(-passed * self._rate)
            self.slope, self.value = (value - self.value) / passed, value
        self._reading = reading

    def at(self, age: float) -> Array:
        """The values (n,) a time [s] after the stamp."""
        return self.value + age * self.slope
