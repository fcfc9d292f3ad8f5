"""The steps that a person makes, as they come: when a foot left the floor, and where it is about to land."""

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.live.person import Moment
from sot.live.steps.foot_sense import FootSense, FootState, percentile, wrapped
from sot.motion.feet.footwork import MIN_STEP_HEIGHT, MIN_STEP_LENGTH, MIN_STEP_TURN, Foothold
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

SWING_TIME = 1.5
"""Time that a step is expected to take before one was seen, in √(leg / g)."""
SWING_TIME_SHARE = 0.3
"""Share of a step's time that the next one's expected time takes over."""
GUESSED_SHARE, EXTRAPOLATED_SHARE = 0.4, 0.7
"""Shares of a step's expected time up to which the body says where it ends, and from which on its way so far does."""
LANDING_AHEAD = 0.5
"""Share of a step's time for which the body goes on until it is over the foot that has landed."""
VELOCITY_TIME = 0.1
"""Time constant of the body's velocity [s]."""
WALKING_SPEED = 0.3
"""Speed of the body from which on it says where a step ends, in leg lengths per second."""
STANCE_SAMPLES = 10
"""Moments from whose median a standing foot's place is told."""
MAX_STEP_LEGS = 2.0
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
        beside: where the other foot stands then, or is expected to.
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
        self._body, self._body_rate, self._at = np.zeros(2), np.zeros(2), -np.inf
        self.swing_time = SWING_TIME * float(np.sqrt(leg / GRAVITY))

    @property
    def stands(self) -> dict[str, Foothold]:
        """Where the feet stand, or stood last."""
        return {foot: own.stand for foot, own in self._feet.items()}

    def __call__(self, moment: Moment, t: float) -> None:
        """Take in a moment at a time [s]."""
        states = self.sense(moment, t)
        body, elapsed = moment.points["waist"][:2], t - self._at
        if 0.0 < elapsed < np.inf:
            rate = (body - self._body) / elapsed
            self._body_rate = self._body_rate + (1.0 - np.exp(-elapsed / VELOCITY_TIME)) * (rate - self._body_rate)
        self._body, self._at = body, t
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
            for step in (own.step, own.last):
                if step is not None and (before := _earlier(other, step)) is not None:
                    step.beside = before.place

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
        step.place = self._expected(step, state.place, t)

    def _expected(self, step: AskedStep, now: Foothold, t: float) -> Foothold:
        """Where a foot lands that is over a place at a time [s].

        At first, as far ahead of the body as its speed says; later, where a minimum-jerk path so far ends.
        """
        time = max(self.swing_time, t - step.lift)
        share = (t - step.lift) / time
        start = np.array([step.start.x, step.start.y])
        way = (np.array([now.x, now.y]) - start) / float(minimum_jerk(np.array(max(share, GUESSED_SHARE))))
        speed = float(np.linalg.norm(self._body_rate))
        if share < EXTRAPOLATED_SHARE and speed > 0.0:
            ahead = self._body + (step.lift + (1.0 + LANDING_AHEAD) * time - t) * self._body_rate
            along = self._body_rate / speed
            guess = max(float((ahead - start) @ along), 0.0) * along
            trust = min(1.0, speed / (WALKING_SPEED * self._leg))
            trust *= min((EXTRAPOLATED_SHARE - share) / (EXTRAPOLATED_SHARE - GUESSED_SHARE), 1.0)
            way = trust * guess + (1.0 - trust) * way
        way *= min(1.0, MAX_STEP_LEGS * self._leg / max(float(np.linalg.norm(way)), 1e-9))
        x, y = start + way
        turned = wrapped(now.heading - step.start.heading)
        return Foothold(float(x), float(y), step.start.heading + turned)

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


def _earlier(other: _Foot, step: AskedStep) -> AskedStep | None:
    """The other foot's step, in the air or just landed, if it lifted before a step: it lands before that, too."""
    return next((one for one in (other.step, other.last) if one is not None and one.lift < step.lift), None)


def _is_far(one: Foothold, other: Foothold, distance: float) -> bool:
    return float(np.hypot(one.x - other.x, one.y - other.y)) > distance


def _median(places: deque[Foothold]) -> Foothold:
    x, y = (percentile([getattr(place, axis) for place in places], 50.0) for axis in "xy")
    last = places[-1].heading
    return Foothold(x, y, last + percentile([wrapped(place.heading - last) for place in places], 50.0))
