"""Frames in order on this end's clock: what is lost, late, doubled or out of order is counted, and never used."""

from collections import Counter, deque

from sot.live.frame import Frame

OFFSET_WINDOW = 10.0
"""Time over which the quickest frame sets how the sender's clock stands to ours [s]."""
MAX_STAMP_JUMP = 1.0
"""Difference between a stamp and when it is expected beyond which a stamp is not believed [s]."""
MAX_DISBELIEF_TIME = 0.5
"""Time of nothing but such stamps after which the sender's clock was set anew [s]."""
MAX_WAITING_FRAMES = 1000
"""Bound of the frames that wait to be due."""


class TimeLine:
    """Puts frames in order and says when each is due.

    A frame is due at ``stamp + offset + delay``: the offset of the two clocks is the least way that a frame of the last
    seconds took, so that jitter and a clock that runs off show as age, and do not move the person in time.

    Args:
        delay: by which everything is played later [s], so that this much of the future is known.

    Attributes:
        counts: frames "lost", "doubled", "late" (an older one was used already) or "absurd stamp", by what befell them.
        offset: of this end's clock to the sender's [s].
    """

    def __init__(self, delay: float = 0.0) -> None:
        self.delay = delay
        self.counts: Counter[str] = Counter()
        self.offset = 0.0
        self._ways: deque[tuple[float, float]] = deque()  # of the window, without those longer than a later one
        self._waiting: list[Frame] = []
        self._last_stamp = -float("inf")
        self._last_sequence: int | None = None
        self._disbelieved_since: float | None = None

    def add(self, frame: Frame) -> None:
        """Take in a frame that has arrived."""
        way = frame.received - frame.stamp
        if self._ways and abs(way - self.offset) > MAX_STAMP_JUMP:
            if self._disbelieved_since is None:
                self._disbelieved_since = frame.received
            if frame.received - self._disbelieved_since < MAX_DISBELIEF_TIME:
                self.counts["absurd stamp"] += 1
                return
            self._start_anew()
        self._disbelieved_since = None
        while self._ways and self._ways[-1][1] >= way:
            self._ways.pop()
        self._ways.append((frame.received, way))
        while self._ways[0][0] < frame.received - OFFSET_WINDOW:
            self._ways.popleft()
        self.offset = self._ways[0][1]
        if frame.stamp <= self._last_stamp:
            self.counts["doubled" if frame.stamp == self._last_stamp else "late"] += 1
        elif any(frame.stamp == other.stamp for other in self._waiting):
            self.counts["doubled"] += 1
        elif len(self._waiting) < MAX_WAITING_FRAMES:
            self._waiting.append(frame)
            self._waiting.sort(key=lambda one: one.stamp)

    def due(self, now: float) -> list[Frame]:
        """The frames that are due by a time [s], in order."""
        ready = [frame for frame in self._waiting if self.due_time(frame) <= now + 1e-9]
        del self._waiting[: len(ready)]
        for frame in ready:
            if self._last_sequence is not None and frame.sequence > self._last_sequence:
                self.counts["lost"] += frame.sequence - self._last_sequence - 1
            self._last_stamp, self._last_sequence = frame.stamp, frame.sequence
        return ready

    def due_time(self, frame: Frame) -> float:
        """When a frame is to be shown, by this end's clock [s]."""
        return frame.stamp + self.offset + self.delay

    def age(self, frame: Frame, now: float) -> float:
        """How long ago the person was there [s]."""
        return now - frame.stamp - self.offset

    def _start_anew(self) -> None:
        self.counts["clock set anew"] += 1
        self._ways.clear()
        self._waiting.clear()
        self._last_stamp, self._last_sequence = -float("inf"), None
