"""Loads that the controller knows of: a mass that is fixed to the robot, and a wrench that acts on it."""

from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.smooth import minimum_jerk

Array = np.ndarray
WrenchProfile = Callable[[float], Array]


class Load:
    """What acts on a point beyond the model; it comes and goes within a ramp.

    Args:
        name: What the stack calls it.
        point: Operational point of the robot.

    Attributes:
        share: How much of it acts now, 0..1; a stack changes it.
    """

    def __init__(self, name: str, point: str) -> None:
        self.name, self.point, self.share = name, point, 1.0
        self._ramp = -np.inf, 0.0, 1.0, 1.0  # start and duration [s], share before and after

    @property
    def is_going(self) -> bool:
        """Whether it is on its way out, or has gone."""
        return self._ramp[3] == 0.0

    def begin_ramp(self, start: float, duration: float, before: float, after: float) -> None:
        """Change the share from one value to another within a time [s], with least jerk."""
        self._ramp = start, duration, before, after
        self.advance(start)

    def advance(self, t: float) -> bool:
        """Let the share be what it is at a time [s]; returns whether its last ramp is over."""
        start, duration, before, after = self._ramp
        done = t >= start + duration
        progress = 1.0 if done else float(minimum_jerk(np.array((t - start) / duration)))
        self.share = before + (after - before) * progress
        return bool(done)


class Carried(Load):
    """A known mass that is fixed to the robot: a bag on the back, a tool in a hand. Mass, centre of mass, momentum and
    the mass matrix of the tick count it.

    Args:
        point: Operational point that it moves with.
        mass: Of it [kg].
        com: Its centre of mass in the point's frame (3,) [m].
        inertia: About its centre of mass, in the point's axes (3, 3) [kg m²]; none unless given.
        name: Unless given, "load at" the point.

    Raises:
        InputError: If the mass is not positive.
    """

    def __init__(
        self,
        point: str,
        mass: float,
        com: Sequence[float] | Array = (0.0, 0.0, 0.0),
        inertia: Array | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(name or f"load at {point}", point)
        if not 0.0 < mass < np.inf:
            raise InputError(f"{self.name}: mass must be positive, not {mass}")
        self.mass = float(mass)
        self.inertia = pin.Inertia(
            self.mass,
            np.array(com, dtype=float),
            np.zeros((3, 3)) if inertia is None else np.array(inertia, dtype=float),
        )

    def present_inertia(self, placement: pin.SE3) -> pin.Inertia:
        """The share of it that acts now, for the body in whose frame the point has a placement."""
        whole = self.inertia
        return placement.act(pin.Inertia(self.share * whole.mass, whole.lever, self.share * whole.inertia))


class KnownWrench(Load):
    """A wrench from outside that the controller is told of: a rope's pull, a tool's reaction.

    Args:
        point: Operational point that it acts at.
        profile: ``t -> wrench`` (6,), force over moment about the point, world axes, or a force (3,) [N, N m]; or one
            of these that does not change.
        name: Unless given, "wrench at" the point.

    Raises:
        InputError: If it has another shape.
    """

    def __init__(self, point: str, profile: WrenchProfile | Sequence[float] | Array, name: str | None = None) -> None:
        super().__init__(name or f"wrench at {point}", point)
        if callable(profile):
            self._profile: WrenchProfile = profile
        else:
            constant = np.array(profile, dtype=float)
            if constant.shape not in ((3,), (6,)):
                raise InputError(f"{self.name}: give a force (3,) or a wrench (6,), not shape {constant.shape}")
            self._profile = lambda t: constant

    def wrench(self, t: float) -> Array:
        """The share of it that acts now, force over moment, shape (6,) [N, N m]."""
        given = self._profile(t)
        out = np.zeros(6)
        out[: len(given)] = self.share * np.asarray(given)
        return out
