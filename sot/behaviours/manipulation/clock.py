"""The clock of a demonstration, which pauses and resumes smoothly."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sot.control.pose import Pose, PoseReference

Array = np.ndarray
VectorReference = Callable[[float], tuple[Array, Array, Array]]


@dataclass(slots=True)
class DemonstrationClock:
    """The demonstration's time s, whose rate ṡ goes critically damped to 1 or to 0.

    ``s⃛ = ω² (goal − ṡ) − 2 ω s̈``: rate and acceleration are continuous, and so is what follows the clock.

    Attributes:
        frequency: ω [1/s].
        time: s [s].
        rate: ṡ.
        acceleration: s̈ [1/s].
        running: Whether the rate goes to 1, else to 0.
        now: The robot's time to which the clock was led last [s].
    """

    frequency: float
    time: float = 0.0
    rate: float = 0.0
    acceleration: float = 0.0
    running: bool = True
    now: float = 0.0

    def advance(self, t: float) -> None:
        """Lead the clock to the robot's time t [s], by the exact solution of its equation."""
        dt, w, goal = t - self.now, self.frequency, float(self.running)
        if dt > 0.0:
            # The rate's distance from its goal is (a + b t) exp(-w t); the way is that plus the goal's.
            a = self.rate - goal
            b = self.acceleration + w * a
            fade = np.exp(-w * dt)
            left = (a + b * dt) * fade
            self.time += goal * dt + (a / w + b / w**2) - (left / w + b / w**2 * fade)
            self.rate, self.acceleration = goal + left, (b - w * (a + b * dt)) * fade
        self.now = t

    @property
    def stopping_time(self) -> float:
        """Where the clock comes to rest if it is stopped now [s]."""
        return self.time + (2.0 * self.rate + self.acceleration / self.frequency) / self.frequency

    def pose(self, path: PoseReference) -> PoseReference:
        """A path over the demonstration's time as a reference over the robot's: ``ẋ = x′ṡ``, ``ẍ = x″ṡ² + x′s̈``."""

        def at(t: float) -> Pose:
            x = path(self.time)
            return Pose(
                x.position,
                x.rotation,
                self.rate * x.velocity,
                self.rate**2 * x.acceleration + self.acceleration * x.velocity,
            )

        return at

    def vector(self, path: VectorReference) -> VectorReference:
        """The same for a vector's position, velocity and acceleration."""

        def at(t: float) -> tuple[Array, Array, Array]:
            position, velocity, acceleration = path(self.time)
            return position, self.rate * velocity, self.rate**2 * acceleration + self.acceleration * velocity

        return at
