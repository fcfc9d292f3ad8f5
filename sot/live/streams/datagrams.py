"""UDP datagrams from whom nobody knows: bounded in size and rate, one sender at a time, and never an exception."""

import socket
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.live.frame import Frame

Address = tuple[str, int]

MAX_DATAGRAM_BYTES = 65_507
"""Size of the largest datagram that UDP carries [bytes]."""
MAX_READS_PER_POLL = 400
"""Bound of the datagrams read at once; what is left waits in the socket's buffer, which is bounded, too."""
MAX_RATE = 2000.0
"""Bound of the datagrams a second that are decoded, of the sender who has the stream [Hz]."""
MAX_STRANGER_RATE = 200.0
"""The same of all others together, while nobody has it [Hz]."""
SENDER_SILENCE = 1.0
"""Time of silence after which a sender loses the stream to the next [s]."""


class Allowance:
    """How many things may still be done, at a rate [Hz] with a second's worth in hand."""

    def __init__(self, rate: float) -> None:
        self._rate, self._left, self._at = rate, rate, -float("inf")

    def take(self, now: float) -> bool:
        """Whether one more may be done at a time [s]."""
        self._left = min(self._rate, self._left + max(now - self._at, 0.0) * self._rate)
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


class Datagrams:
    """A bound socket, and whose datagrams count.

    The first sender of a datagram that can be decoded keeps the stream until it has been silent for `SENDER_SILENCE`.

    Args:
        host, port: where to listen.

    Attributes:
        counts: datagrams that were dropped, by reason.
        sender: who has the stream.

    Raises:
        InputError: nothing can listen there.
    """

    def __init__(self, host: str, port: int) -> None:
        self.counts: Counter[str] = Counter()
        self.sender: Address | None = None
        self._heard_at = -float("inf")
        self._own, self._strangers = Allowance(MAX_RATE), Allowance(MAX_STRANGER_RATE)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except (OSError, OverflowError) as error:
            self._socket.close()
            reason = getattr(error, "strerror", None) or error
            raise InputError(f"cannot listen at {host}:{port} ({reason}): choose another port or --bind") from None
        self._socket.setblocking(False)

    @property
    def port(self) -> int:
        """The port that it listens at."""
        return int(self._socket.getsockname()[1])

    def receive(self, now: float, decode: Callable[[bytes, Address], bool]) -> None:
        """Hand what has arrived by a time [s] to `decode`, which says whether it was a datagram of the protocol."""
        for _ in range(MAX_READS_PER_POLL):
            try:
                content, address = self._socket.recvfrom(MAX_DATAGRAM_BYTES)
            except BlockingIOError:
                return
            except OSError:  # an earlier answer met a closed port
                self.counts["socket error"] += 1
                continue
            held = self.sender is not None and now - self._heard_at < SENDER_SILENCE
            if held and address != self.sender:
                self.counts["other sender"] += 1
            elif not (self._own if held else self._strangers).take(now):
                self.counts["too many"] += 1
            elif decode(content, address):
                if not held and address != self.sender:
                    self.counts["senders"] += 1
                self.sender, self._heard_at = address, now

    def send(self, content: bytes, address: Address) -> None:
        """Send a datagram to somebody, or nothing where the network does not take it."""
        try:
            self._socket.sendto(content, address)
        except OSError:
            self.counts["not sent"] += 1

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class DatagramSource(ABC):
    """A source whose frames come in datagrams; each protocol says how they are decoded.

    Args:
        scheme: of its address.
        host, port: where to listen.

    Attributes:
        name: its address.
        counts: datagrams that were dropped, by reason.

    Raises:
        InputError: nothing can listen there.
    """

    def __init__(self, scheme: str, host: str, port: int) -> None:
        self.name = f"{scheme}://{host}:{port}"
        self.ended = False
        self._datagrams = Datagrams(host, port)
        self.counts: Counter[str] = self._datagrams.counts
        self._frames: list[Frame] = []
        self._now = 0.0

    @property
    def port(self) -> int:
        """The port that it listens at."""
        return self._datagrams.port

    def poll(self, now: float) -> list[Frame]:
        """Frames that have been completed by a time [s]."""
        self._now, self._frames = now, []
        self._datagrams.receive(now, self._decode)
        return self._frames

    @abstractmethod
    def _decode(self, content: bytes, address: Address) -> bool:
        """Take in a datagram, which may complete frames; whether it is one of the protocol."""

    def reply(self, now: float, joints: NDArray[np.float64]) -> None:
        """Tell joint targets (na,) [rad] to those who have asked; most protocols have no way back."""
        del now, joints

    def close(self) -> None:
        """Close the socket."""
        self._datagrams.close()
