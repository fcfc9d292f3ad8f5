"""A stream over a real loopback socket that is paced by the run's own time: load cannot change what comes out."""

from collections.abc import Callable, Sequence

from sot.live.clip_source import ClipSource
from sot.live.frame import Frame
from sot.live.streams.address import Sender, StreamAddress, clip_for
from sot.motion.human.capture import Capture

Fault = Callable[[Frame, float], Sequence[tuple[float, Frame]]]
"""A frame and the time -> what is sent instead, and when [s]."""


class PacedStream:
    """A source that has a clip sent to itself by a scheme's protocol."""

    ended = False

    def __init__(self, scheme: str, capture: Capture, rate: float = 50.0, fault: Fault | None = None) -> None:
        self._source = StreamAddress(scheme, "127.0.0.1", 0).open()
        address = StreamAddress(scheme, "127.0.0.1", self._source.port)
        self._clip, self._sender = ClipSource(clip_for(address, capture), rate), Sender(address)
        self.name, self.counts = self._source.name, self._source.counts
        self._fault, self._waiting = fault, []

    def poll(self, now: float) -> list[Frame]:
        for frame in self._clip.poll(now):
            self._waiting += self._fault(frame, now) if self._fault else [(now, frame)]
        self._waiting.sort(key=lambda sent: sent[0])
        while self._waiting and self._waiting[0][0] <= now:
            self._sender.send(self._waiting.pop(0)[1])
        return self._source.poll(now)

    def reply(self, now, joints) -> None:
        self._source.reply(now, joints)

    def close(self) -> None:
        self._sender.close()
        self._source.close()
