"""Addresses of streams, such as vmc://127.0.0.1:39539, and what opens them."""

import ipaddress
import socket
from contextlib import suppress
from dataclasses import dataclass
from urllib.parse import urlsplit

from sot.errors import InputError
from sot.live.frame import Frame, Source
from sot.live.streams import json_udp, rokoko, vmc
from sot.live.streams.bones import bones_of_clip
from sot.motion.human.capture import Capture

DEFAULT_PORTS = {"udp": json_udp.DEFAULT_PORT, "vmc": vmc.DEFAULT_PORT, "rokoko": rokoko.DEFAULT_PORT}


MAX_ANSWER_BYTES = 4096


@dataclass(frozen=True)
class StreamAddress:
    """Protocol, host and port of a stream."""

    scheme: str
    host: str
    port: int

    @staticmethod
    def is_one(text: str) -> bool:
        """Whether a text is meant as an address, and not as a clip."""
        return "://" in text

    @classmethod
    def parse(cls, text: str) -> "StreamAddress":
        """The address that a text gives; host and port may be left out.

        Raises:
            InputError: it is none.
        """
        schemes = ", ".join(f"{scheme}://" for scheme in DEFAULT_PORTS)
        scheme = text.partition("://")[0].lower()
        if scheme not in DEFAULT_PORTS:
            raise InputError(f"{text}: unknown stream; choose one of {schemes}")
        try:
            parts = urlsplit(text)
            host, port = parts.hostname or "127.0.0.1", parts.port
        except ValueError as error:
            raise InputError(f"{text}: no address ({error}); write {scheme}://HOST:PORT") from None
        if parts.path.strip("/") or parts.query or parts.fragment or parts.username:
            raise InputError(f"{text}: write {scheme}://HOST:PORT, and nothing after it")
        return cls(scheme, host, DEFAULT_PORTS[scheme] if port is None else port)

    def open(self, bind: str | None = None, token: str = "", joints: tuple[str, ...] = ()) -> Source:
        """A source that listens there.

        Args:
            bind: the address of an interface; without it, only this machine is listened to.
            token: what frames have to carry; of udp:// only.
            joints: names of the robot's joints, for those who ask for targets.

        Raises:
            InputError: nothing can listen there, or the address is another machine's and `bind` does not say so.
        """
        if token and self.scheme != "udp":
            raise InputError(f"{self.scheme}:// knows no token: leave --token out, or use udp://")
        if bind is None and not _is_loopback(self.host):
            raise InputError(
                f"{self.host} is not this machine's loopback: add --bind {self.host} to be reached by others"
            )
        host = bind or self.host
        match self.scheme:
            case "vmc":
                return vmc.VmcSource(host, self.port)
            case "rokoko":
                return rokoko.RokokoSource(host, self.port)
            case _:
                return json_udp.JsonUdpSource(host, self.port, token, joints)


class Sender:
    """Sends frames of a clip as a stream.

    Args:
        address: where to.
        token: that the receiver wants; of udp:// only.

    Raises:
        InputError: no such host.
    """

    def __init__(self, address: StreamAddress, token: str = "") -> None:
        self._address, self._token = address, token
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.connect((address.host, address.port))
        except (OSError, OverflowError) as error:
            self._socket.close()
            raise InputError(f"{address.host}:{address.port} cannot be reached ({error})") from None
        self._socket.setblocking(False)

    def encoded(self, frame: Frame) -> list[bytes]:
        """The datagrams of a frame."""
        match self._address.scheme:
            case "vmc":
                return vmc.encoded_frame(frame)
            case "rokoko":
                return rokoko.encoded_frame(frame)
            case _:
                return json_udp.encoded_frame(frame, self._token)

    def send(self, frame: Frame) -> None:
        """Send a frame; nobody need be there.

        Raises:
            InputError: the receiver wants another token.
        """
        for content in self.encoded(frame):
            with suppress(OSError):  # nobody is there yet
                self._socket.send(content)
        self.check_refused()

    def check_refused(self) -> None:
        """See whether the receiver has answered that it wants another token.

        Raises:
            InputError: it has.
        """
        try:
            answer = self._socket.recv(MAX_ANSWER_BYTES)
        except OSError:
            return
        if b'"refused"' in answer:
            where = f"udp://{self._address.host}:{self._address.port}"
            raise InputError(f"{where} wants another token: give the one that `sot live --token` has")

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def clip_for(address: StreamAddress, capture: Capture) -> Capture:
    """A clip with the joints that a protocol can name."""
    if address.scheme == "udp":
        return capture
    skeleton, joints = bones_of_clip(capture)
    return Capture(
        capture.name,
        capture.rate,
        skeleton.joints,
        skeleton.parents,
        capture.positions[:, joints],
        capture.rotations[:, joints],
    )


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
