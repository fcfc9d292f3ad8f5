"""The shipped clip as a live source, and what can befall its frames."""

from collections import Counter
from dataclasses import replace

from scenarios.inputs import clips
from sot.live.clip_source import ClipSource
from sot.live.frame import Frame
from sot.motion import read


def groove(rate: float = 50.0) -> ClipSource:
    """The clip, at a rate [Hz]."""
    return ClipSource(read(clips.find_clip("groove")), rate)


class Spoilt:
    """A source whose frames somebody spoils: `spoil(frame, now)` returns those that arrive instead."""

    name, ended = "spoilt", False

    def __init__(self, spoil, rate: float = 50.0):
        self._source, self._spoil, self.counts = groove(rate), spoil, Counter()

    def poll(self, now: float) -> list[Frame]:
        return [one for frame in self._source.poll(now) for one in self._spoil(frame, now)]

    def reply(self, now, joints):
        pass

    def close(self):
        pass


def moved(frame: Frame, by) -> Frame:
    return replace(frame, positions=frame.positions + by)
