"""The Virtual Motion Capture protocol: OSC messages over UDP, bones local to their parents, in Unity's axes."""

import numpy as np
from numpy.typing import NDArray
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.osc_packet import OscPacket
from scipy.spatial.transform import Rotation

from sot.live.frame import Frame, Skeleton
from sot.live.streams import checks
from sot.live.streams.bones import LIMB_BONES, skeleton_of
from sot.live.streams.checks import Malformed
from sot.live.streams.datagrams import Address, DatagramSource
from sot.live.streams.unity_axes import positions_to_unity, positions_to_world, rotations_to_unity, rotations_to_world

Array = NDArray[np.float64]

DEFAULT_PORT = 39539
ROOT, BONE, TIME = "/VMC/Ext/Root/Pos", "/VMC/Ext/Bone/Pos", "/VMC/Ext/T"
MAX_BUNDLE_BYTES = 1200
"""Size of a sender's datagrams: one that a network need not cut [bytes]."""
MAX_TIME_S = 1e12

PARENTS = {
    "Spine": "Hips",
    "Chest": "Spine",
    "UpperChest": "Chest",
    "Neck": "UpperChest",
    "Head": "Neck",
    **{f"{side}Shoulder": "UpperChest" for side in ("Left", "Right")},
    **{
        side + bone: "Hips" if bone == "UpperLeg" else f"{side}Shoulder" if bone == "UpperArm" else side + parent
        for side in ("Left", "Right")
        for bone, (_, parent) in LIMB_BONES.items()
    },
}
"""Unity's humanoid bones without fingers, eyes and jaw: bone -> parent, which may be left out."""
BONES = ("Hips", *PARENTS)


class VmcSource(DatagramSource):
    """Receives bones, and puts those of one moment together.

    A frame spans several datagrams. It is complete with the last of the bones that the frame before had, or where the
    next one begins: with the sender's time, or a bone that is there already.

    Args:
        host, port: where to listen.

    Raises:
        InputError: nothing can listen there.
    """

    def __init__(self, host: str, port: int) -> None:
        super().__init__("vmc", host, port)
        self._bones: dict[str, Array] = {}
        self._expected: frozenset[str] = frozenset()
        self._root = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        self._stamp: float | None = None
        self._sequence = 0
        self._skeleton = Skeleton((), ())

    def _decode(self, content: bytes, address: Address) -> bool:
        try:
            messages = [timed.message for timed in OscPacket(content).messages]
        except Exception:  # the library's parser raises whatever a byte out of place makes it raise
            self.counts["not OSC"] += 1
            return False
        try:
            return any([self._take_in(message) for message in messages])
        except Malformed as error:
            self.counts[str(error)] += 1
            return False

    def _take_in(self, message: OscMessage) -> bool:
        """Take in a message; whether it is one of a person's."""
        values = message.params
        if message.address == TIME:
            if len(values) != 1:
                raise Malformed("shape")
            stamp = checks.number(values[0], MAX_TIME_S)
            self._complete()
            self._stamp = stamp
        elif message.address in (BONE, ROOT):
            if len(values) < 8 or not isinstance(values[0], str):
                raise Malformed("shape")
            pose = checks.finite(np.array([checks.number(value, checks.MAX_COORDINATE_M) for value in values[1:8]]))
            pose[3:] = checks.quaternions(pose[None, 3:])[0]
            if message.address == ROOT:
                self._root = pose
            elif values[0] in BONES:
                if values[0] in self._bones:
                    self._complete()
                self._bones[values[0]] = pose
                if self._expected and self._expected <= self._bones.keys():
                    self._complete()
        else:
            return False
        return True

    def _complete(self) -> None:
        """Make a frame of the bones that are there."""
        if "Hips" not in self._bones:
            self._bones.clear()
            return
        bones = [bone for bone in BONES if bone in self._bones]
        self._expected = frozenset(bones)
        if self._skeleton.joints != tuple(bones):
            self._skeleton = skeleton_of(PARENTS, bones)
        local = np.array([self._bones[bone] for bone in bones])
        self._bones.clear()
        turns, places = Rotation.from_quat(local[:, 3:]).as_matrix(), local[:, :3]
        turn, place = Rotation.from_quat(self._root[3:]).as_matrix(), self._root[:3]
        for k, parent in enumerate(self._skeleton.parents):
            above, origin = (turn, place) if parent < 0 else (turns[parent], places[parent])
            places[k], turns[k] = origin + above @ places[k], above @ turns[k]
        positions = positions_to_world(places)
        if not np.abs(positions).max() < checks.MAX_COORDINATE_M:
            raise Malformed("too large")
        rotations = rotations_to_world(Rotation.from_matrix(turns).as_quat())
        self._sequence += 1
        stamp, self._stamp = self._now if self._stamp is None else self._stamp, None
        self._frames.append(Frame(self._skeleton, positions, rotations, stamp, self._sequence, self._now))


def encoded_frame(frame: Frame) -> list[bytes]:
    """A frame of Unity's bones (`bones_of_clip`) as datagrams: the time first, then bundles of bones."""
    assert frame.rotations is not None
    turns, places = frame.rotations, frame.positions
    messages = [_message(TIME, frame.stamp), _message(ROOT, "root", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)]
    for k, (bone, parent) in enumerate(zip(frame.skeleton.joints, frame.skeleton.parents, strict=True)):
        turn, place = turns[k], places[k]
        if parent >= 0:
            turn, place = turns[parent].T @ turn, turns[parent].T @ (place - places[parent])
        pose = (*positions_to_unity(place), *rotations_to_unity(turn[None])[0])
        messages.append(_message(BONE, bone, *pose))
    datagrams, bundle, size = [], OscBundleBuilder(IMMEDIATELY), 16
    for message in messages:
        if size + message.size + 4 > MAX_BUNDLE_BYTES:
            datagrams.append(bundle.build().dgram)
            bundle, size = OscBundleBuilder(IMMEDIATELY), 16
        bundle.add_content(message)
        size += message.size + 4
    return [*datagrams, bundle.build().dgram]


def _message(address: str, *values: float | str) -> OscMessage:
    builder = OscMessageBuilder(address)
    for value in values:
        builder.add_arg(value if isinstance(value, str) else float(value), "s" if isinstance(value, str) else "f")
    return builder.build()
