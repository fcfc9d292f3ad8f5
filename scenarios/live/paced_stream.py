"""A stream over a real loopback socket that is paced by the run's own time: load cannot change what comes out."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from sot.live.clip_source import ClipSource
from sot.live.frame import Frame
from sot.live.streams.address import Sender, StreamAddress, clip_for
from sot.live.streams.datagrams import DatagramSource
from sot.motion.human.capture import Capture

Array = NDArray[np.float64]

Fault = Callable[[Frame, float], Sequence[tuple[float, Frame]]]
"""A frame and the time -> what is sent instead, and when [s]."""


class PacedStream:
    """A source that has a clip sent to itself by a scheme's protocol.

    Args:
        scheme: of the stream's address.
        capture: the clip.
        rate: frames a second [Hz].
        fault: what befalls the frames.
    """

    def __init__(self, scheme: str, capture: Capture, rate: float = 50.0, fault: Fault | None = None) -> None:
        self._source = StreamAddress(scheme, "127.0.0.1", 0).open()
        assert isinstance(self._source, DatagramSource)
        address = StreamAddress(scheme, "127.0.0.1", self._source.port)
        self._clip, self._sender = ClipSource(clip_for(address, capture), rate), Sender(address)
        self.name, self.counts = self._source.name, self._source.counts
        self._fault, self._waiting = fault, list[tuple[float, Frame]]()

    @property
    def ended(self) -> bool:
        """Whether all of the clip has been sent."""
        return self._clip.ended and not self._waiting

    def poll(self, now: float) -> list[Frame]:
        """The frames that have arrived."""
        for frame in self._clip.poll(now):
            self._waiting += self._fault(frame, now) if self._fault else [(now, frame)]
        self._waiting.sort(key=lambda sent: sent[0])
        while self._waiting and self._waiting[0][0] <= now:
            self._sender.send(self._waiting.pop(0)[1])
        return self._source.poll(now)

    def reply(self, now: float, joints: Array) -> None:
        """Send joint targets to those who have asked for them."""
        self._source.reply(now, joints)

    def close(self) -> None:
        """Close both ends."""
        self._sender.close()
        self._source.close()
