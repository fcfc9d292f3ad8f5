"""The project's own protocol, version 1: JSON objects over UDP, one a datagram (docs/live.md)."""

import hmac
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.live.frame import Frame, Skeleton
from sot.live.streams import checks
from sot.live.streams.checks import Malformed
from sot.live.streams.datagrams import Address, Allowance, DatagramSource

Array = NDArray[np.float64]

VERSION = 1
DEFAULT_PORT = 14044
MAX_STAMP_S = 1e12
MAX_SEQUENCE = 2**53
MAX_LISTENERS = 8
"""Bound of those who are told joint targets."""
LISTENER_TIME = 5.0
"""Time for which one who has asked is told [s]; asking again prolongs it."""
REFUSALS_PER_SECOND = 1.0
"""Bound of how often a wrong token is answered [Hz]: an answer to a forged address hits somebody else."""


class JsonUdpSource(DatagramSource):
    """Receives frames, and tells joint targets to whoever asks for them.

    Args:
        host, port: where to listen.
        token: that frames and questions have to carry; none if empty.
        joints: names of the robot's joints, told with the targets.

    Raises:
        InputError: nothing can listen there.
    """

    def __init__(self, host: str, port: int, token: str = "", joints: tuple[str, ...] = ()) -> None:
        super().__init__("udp", host, port)
        self._token, self._joints = token, joints
        self._skeleton: Skeleton | None = None
        self._listeners: dict[Address, float] = {}
        self._refusals = Allowance(REFUSALS_PER_SECOND)

    def _decode(self, content: bytes, address: Address) -> bool:
        try:
            message = json.loads(content)
            if not isinstance(message, dict) or message.get("sot") != VERSION:
                raise Malformed("version")
            token = message.get("token", "")
            if not isinstance(token, str) or not hmac.compare_digest(token.encode(), self._token.encode()):
                self._refuse(address)
                raise Malformed("wrong token")
            if message.get("type") == "subscribe":
                self._subscribe(address)
                return False  # to listen is not to have the stream
            self._frames.append(self._frame(message))
            return True
        except Malformed as error:
            self.counts[str(error)] += 1
        except (ValueError, RecursionError):
            self.counts["not JSON"] += 1
        return False

    def _frame(self, message: dict[str, Any]) -> Frame:
        joints = checks.names(message.get("joints"))
        count = len(joints)
        skeleton = Skeleton(joints, checks.parents(message.get("parents"), count))
        if skeleton == self._skeleton:
            skeleton = self._skeleton
        self._skeleton = skeleton
        positions = checks.table(message.get("positions"), count, 3)
        turns = message.get("rotations")
        rotations = None if turns is None else checks.rotations(checks.table(turns, count, 4))
        stamp = checks.number(message.get("stamp"), MAX_STAMP_S)
        sequence = int(checks.number(message.get("sequence"), MAX_SEQUENCE))
        return Frame(skeleton, positions, rotations, stamp, sequence, self._now)

    def _refuse(self, address: Address) -> None:
        if self._refusals.take(self._now):
            self._datagrams.send(_encoded({"type": "refused", "reason": "wrong token"}), address)

    def _subscribe(self, address: Address) -> None:
        self._listeners = {one: until for one, until in self._listeners.items() if until > self._now}
        if address in self._listeners or len(self._listeners) < MAX_LISTENERS:
            self._listeners[address] = self._now + LISTENER_TIME
        else:
            self.counts["listener refused"] += 1

    def reply(self, now: float, joints: Array) -> None:
        """Tell joint targets (na,) [rad] to those who have asked."""
        told = [one for one, until in self._listeners.items() if until > now]
        if told:
            targets = {"type": "targets", "stamp": now, "joints": self._joints, "positions": joints.round(6).tolist()}
            content = _encoded(targets)
            for one in told:
                self._datagrams.send(content, one)


def encoded_frame(frame: Frame, token: str = "") -> list[bytes]:
    """A frame as the datagram of the protocol, in a list."""
    message: dict[str, Any] = {
        "type": "frame",
        "token": token,
        "sequence": frame.sequence,
        "stamp": frame.stamp,
        "joints": frame.skeleton.joints,
        "parents": frame.skeleton.parents,
        "positions": frame.positions.round(5).tolist(),
    }
    if frame.rotations is not None:
        message["rotations"] = Rotation.from_matrix(frame.rotations).as_quat().round(6).tolist()
    return [_encoded(message)]


def _encoded(message: dict[str, Any]) -> bytes:
    return json.dumps({"sot": VERSION, **message}, separators=(",", ":")).encode()
