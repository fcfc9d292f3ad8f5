"""The steps that a person makes, as they come: when a foot left the floor, and where it is about to land."""

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.live.person import Moment
from sot.live.steps.foot_sense import FootSense, FootState, wrapped
from sot.motion.feet.footwork import MIN_STEP_HEIGHT, MIN_STEP_LENGTH, MIN_STEP_TURN, Foothold
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

SWING_TIME = 1.5
"""Time that a step is expected to take before one was seen, in √(leg / g)."""
SWING_TIME_SHARE = 0.3
"""Share of a step's time that the next one's expected time takes over."""
EARLIEST_EXTRAPOLATION = 0.4
"""Share of a step's expected time after which its way so far says where it ends."""
STANCE_SAMPLES = 10
"""Moments from whose median a standing foot's place is told."""
MAX_STEP_LEGS = 1.2
"""Bound of the length that a step is expected to have, in leg lengths."""
DECIDED_SHARE = 0.5
"""Share of what makes a step worth while that a foot has gone when its step is believed."""


@dataclass
class AskedStep:
    """A step of the person; what is expected of it changes until it has landed.

    Attributes:
        foot: which one.
        lift: when it began to move, in order to leave the floor [s].
        land: when it lands, or is expected to [s].
        start: where it stood.
        place: where it lands, or is expected to.
        beside: where the other foot stood.
        height: how high it has got [m].
        has_landed: whether it has.
    """

    foot: str
    lift: float
    land: float
    start: Foothold
    place: Foothold
    beside: Foothold
    height: float = 0.0
    has_landed: bool = False


@dataclass
class _Foot:
    """A foot's stance, and its step while it is in the air."""

    stand: Foothold
    recent: deque[Foothold] = field(default_factory=lambda: deque(maxlen=STANCE_SAMPLES))
    moves_since: float | None = None
    lifted: float | None = None
    step: AskedStep | None = None
    last: AskedStep | None = None


class PersonSteps:
    """Finds a person's steps.

    Args:
        leg: length of the person's legs [m].

    Attributes:
        asked: steps that nobody has taken yet, in order of their lifts.
        sense: of the feet.
    """

    def __init__(self, leg: float) -> None:
        self.asked: deque[AskedStep] = deque()
        self.sense = FootSense(leg)
        self._leg, self._feet = leg, dict[str, _Foot]()
        self.swing_time = SWING_TIME * float(np.sqrt(leg / GRAVITY))

    @property
    def stands(self) -> dict[str, Foothold]:
        """Where the feet stand, or stood last."""
        return {foot: own.stand for foot, own in self._feet.items()}

    def __call__(self, moment: Moment, t: float) -> None:
        """Take in a moment at a time [s]."""
        states = self.sense(moment, t)
        if not self._feet:
            self._feet = {foot: _Foot(state.place) for foot, state in states.items()}
        for foot, state in states.items():
            own, other = self._feet[foot], next(one for name, one in self._feet.items() if name != foot)
            if state.is_still:
                own.moves_since = None
            elif own.moves_since is None:
                own.moves_since = t
            if state.touches:
                self._stands(own, foot, other, state, t)
            else:
                self._swings(own, foot, other, state, t)

    def _swings(self, own: _Foot, foot: str, other: _Foot, state: FootState, t: float) -> None:
        if own.lifted is None:
            own.lifted, own.last = own.moves_since or t, None
            own.recent.clear()
        if own.step is None:
            high = state.height > DECIDED_SHARE * MIN_STEP_HEIGHT * self._leg
            if not (high or _is_far(own.stand, state.place, DECIDED_SHARE * MIN_STEP_LENGTH[0] * self._leg)):
                return
            own.step = AskedStep(
                foot, own.lifted, own.lifted + self.swing_time, own.stand, state.place, other.stand, state.height
            )
            self.asked.append(own.step)
        step = own.step
        step.height = max(step.height, state.height)
        step.land = max(step.land, t)
        step.place = self._expected(own.stand, state.place, (t - step.lift) / max(self.swing_time, t - step.lift))

    def _expected(self, start: Foothold, now: Foothold, share: float) -> Foothold:
        """Where a foot lands that has gone so far in a share of its time: along a minimum-jerk path."""
        done = float(minimum_jerk(np.array(max(share, EARLIEST_EXTRAPOLATION))))
        way = np.array([now.x - start.x, now.y - start.y]) / done
        way *= min(1.0, MAX_STEP_LEGS * self._leg / max(float(np.linalg.norm(way)), 1e-9))
        return Foothold(
            start.x + float(way[0]), start.y + float(way[1]), start.heading + wrapped(now.heading - start.heading)
        )

    def _stands(self, own: _Foot, foot: str, other: _Foot, state: FootState, t: float) -> None:
        if own.lifted is not None:
            step, own.lifted, own.step = own.step, None, None
            if step is not None:
                step.land, step.has_landed, own.last = t, True, step
                self.swing_time += SWING_TIME_SHARE * (step.land - step.lift - self.swing_time)
        own.recent.append(state.place)
        place = _median(own.recent)
        if own.last is not None:  # it settles
            own.last.place = own.stand = place
            if len(own.recent) == STANCE_SAMPLES:
                own.last = None
        elif state.is_still and self._has_slid(own.stand, place):
            self.asked.append(AskedStep(foot, t, t, own.stand, place, other.stand, has_landed=True))
            own.stand = place

    def _has_slid(self, stand: Foothold, place: Foothold) -> bool:
        turned = abs(wrapped(place.heading - stand.heading)) > MIN_STEP_TURN
        return turned or _is_far(stand, place, MIN_STEP_LENGTH[1] * self._leg)


def _is_far(one: Foothold, other: Foothold, distance: float) -> bool:
    return float(np.hypot(one.x - other.x, one.y - other.y)) > distance


def _median(places: deque[Foothold]) -> Foothold:
    x, y = (float(np.median([getattr(place, axis) for place in places])) for axis in "xy")
    last = places[-1].heading
    return Foothold(x, y, last + float(np.median([wrapped(place.heading - last) for place in places])))
