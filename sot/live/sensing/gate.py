"""Frames that no person can make are not believed; a person who is somewhere else now is, after a while."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.live.person import Moment, Person
from sot.motion.human.human import SEGMENTS

Array = NDArray[np.float64]

MAX_SPEED_FROUDE = 4.0
"""Bound of a point's speed over √(g leg)."""
MAX_TURN_RATE = 30.0
"""Bound of how fast pelvis, chest and head turn [rad/s]."""
POINT_SLACK_LEGS, TURN_SLACK = 0.05, 0.5
"""What noise adds to the way from one frame to the next, in leg lengths and [rad]."""
MAX_LENGTH_ERROR = 0.35
"""Share by which a segment may be longer or shorter than it was calibrated."""
PERSISTENCE = 0.3
"""Time for which a jump has to go on as a motion of its own to be believed [s]."""
STRANGER_TIME = 1.0
"""Time of other proportions after which it is another person [s]."""


class Gate:
    """Passes moments that follow from the last one that was passed.

    Args:
        person: whose proportions they must have.

    Attributes:
        counts: moments that were held back, by reason.
        jumped: whether the last one that passed did so after a jump.
        is_stranger: whether another person has come.
    """

    def __init__(self, person: Person, counts: Counter[str]) -> None:
        self._person, self.counts = person, counts
        self.jumped = self.is_stranger = False
        self._last: tuple[Moment, float] | None = None
        self._held: tuple[Moment, float] | None = None
        self._jumping_since = self._strange_since = self._doubtful_since = np.inf

    def passes(self, moment: Moment, t: float) -> bool:
        """Whether a moment at a time [s] is to be believed."""
        self.jumped = False
        if not self._has_proportions(moment):
            self._strange_since = min(self._strange_since, t)
            self.is_stranger = t - self._strange_since > STRANGER_TIME
            self.counts["other proportions"] += 1
            return False
        self._strange_since = np.inf
        if self._last is not None and not self._follows(moment, min(t, self._doubtful_since), *self._last):
            self._doubtful_since = min(self._doubtful_since, t)
            if self._held is None or not self._follows(moment, t, *self._held):
                self._jumping_since = t
            self._held = moment, t
            if t - self._jumping_since < PERSISTENCE:
                self.counts["jump"] += 1
                return False
            self.jumped = True
            self.counts["jump believed"] += 1
        self._last, self._held, self._doubtful_since = (moment, t), None, np.inf
        return True

    def _has_proportions(self, moment: Moment) -> bool:
        for segment, length in self._person.lengths.items():
            near, far = SEGMENTS[segment]
            now = float(np.linalg.norm(moment.points[far] - moment.points[near]))
            if not abs(now - length) <= MAX_LENGTH_ERROR * length:
                return False
        return True

    def _follows(self, moment: Moment, t: float, last: Moment, at: float) -> bool:
        """Whether one moment can come after another: of frames in doubt, none has had longer than the first of them."""
        elapsed, leg = max(t - at, 0.0), self._person.leg
        way = elapsed * MAX_SPEED_FROUDE * np.sqrt(GRAVITY * leg) + POINT_SLACK_LEGS * leg
        moved = np.array([moment.points[name] - last.points[name] for name in moment.points])
        if np.max(np.sum(moved**2, axis=1)) > way**2:
            return False
        turn = np.cos(min(elapsed * MAX_TURN_RATE + TURN_SLACK, np.pi))
        cosines = [0.5 * (np.sum(moment.frames[body] * last.frames[body]) - 1.0) for body in moment.frames]
        return bool(min(cosines) >= turn)
