"""A motion as a clock that pauses has played it: what a run is compared with afterwards."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.contacts import Phase
from sot.motion.objects.events import ContactSets
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Waiting:
    """A time in which the demonstration stood still: which events it waited for, in words, from when to when [s]."""

    what: str
    start: float
    end: float


def played_motion(
    motion: Motion, clock: Array, com: Array, history: Sequence[tuple[float, ContactSets]], rate: float
) -> Motion:
    """The motion at the times of a clock, with the centre of mass as it was led.

    Args:
        motion: What the clock plays.
        clock: Time, rate and acceleration of the clock at every tick (T, 3).
        com: Position, velocity and acceleration of the led centre of mass over the floor (T, 3, 2).
        history: When the sets of supports changed, and to what; the first at the start.
        rate: Ticks per second [Hz].
    """
    samples = [motion.sample(t) for t in clock[:, 0].tolist()]
    pace, change = clock[:, 1:2], clock[:, 2:3]
    q = np.array([sample.q for sample in samples])
    v, a = (np.array([getattr(sample, name) for sample in samples]) for name in ("v", "a"))
    fields = {name: np.array([getattr(sample, name) for sample in samples]) for name in ("com", "com_velocity")}
    height, climb = fields["com"][:, 2:], pace * fields["com_velocity"][:, 2:]
    acceleration = np.column_stack([com[:, 2], np.gradient(climb[:, 0], 1.0 / rate)])
    feet = {foot: motion.phases[0].feet[foot] for foot in motion.robot.feet}
    ends = [*(t for t, _ in history[1:]), (len(clock) - 1) / rate]
    phases = tuple(
        Phase(start, end, {foot: place for foot, place in feet.items() if foot in sets.supports})
        for (start, sets), end in zip(history, ends, strict=True)
        if end > start
    )
    return Motion(
        robot=motion.robot,
        rate=rate,
        q=q,
        v=pace * v,
        a=pace**2 * a + change * v,
        com=np.column_stack([com[:, 0], height]),
        com_velocity=np.column_stack([com[:, 1], climb]),
        com_acceleration=acceleration,
        zmp=com[:, 0].copy(),
        momentum=pace * np.array([motion.angular_momentum(t) for t in clock[:, 0].tolist()]),
        phases=_joined(phases),
    )


def _joined(phases: Sequence[Phase]) -> tuple[Phase, ...]:
    """Phases with neighbours joined in which the same feet stand."""
    joined: list[Phase] = []
    for phase in phases:
        if joined and set(joined[-1].feet) == set(phase.feet):
            joined[-1] = Phase(joined[-1].start, phase.end, phase.feet)
        else:
            joined.append(phase)
    return tuple(joined)
