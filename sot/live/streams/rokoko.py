"""Rokoko Studio's JSON, version 3, plain or LZ4: bones of actors in a scene, in Unity's axes."""

import json
from typing import Any

import lz4.frame
import numpy as np
from numpy.typing import NDArray

from sot.live.frame import Frame, Skeleton
from sot.live.streams import checks
from sot.live.streams.bones import LIMB_BONES, skeleton_of
from sot.live.streams.checks import Malformed
from sot.live.streams.datagrams import Address, DatagramSource
from sot.live.streams.unity_axes import positions_to_unity, positions_to_world, rotations_to_unity, rotations_to_world

Array = NDArray[np.float64]

DEFAULT_PORT = 14043
LZ4_MAGIC = b"\x04\x22\x4d\x18"
MAX_PLAIN_BYTES = 1_000_000
"""Bound of a datagram once it is decompressed [bytes]."""
MAX_STAMP_S = 1e12

LIMB_NAMES = {"UpperLeg": "UpLeg", "LowerLeg": "Leg", "Toes": "Toe"}
NAME_OF_BONE = {
    "Hips": "hip",
    "Spine": "spine",
    "Chest": "chest",
    "Neck": "neck",
    "Head": "head",
    **{
        side.capitalize() + bone: side + LIMB_NAMES.get(bone, bone)
        for side in ("left", "right")
        for bone in ("Shoulder", *LIMB_BONES)
    },
}
"""Unity's bone -> Rokoko's name for it."""
PARENTS = {
    "Spine": "Hips",
    "Chest": "Spine",
    "Neck": "Chest",
    "Head": "Neck",
    **{f"{side}Shoulder": "Chest" for side in ("Left", "Right")},
    **{
        side + bone: "Hips" if bone == "UpperLeg" else f"{side}Shoulder" if bone == "UpperArm" else side + parent
        for side in ("Left", "Right")
        for bone, (_, parent) in LIMB_BONES.items()
    },
}


class RokokoSource(DatagramSource):
    """Receives the first actor of each datagram.

    Args:
        host, port: where to listen.

    Raises:
        InputError: nothing can listen there.
    """

    def __init__(self, host: str, port: int) -> None:
        super().__init__("rokoko", host, port)
        self._skeleton = Skeleton((), ())
        self._sequence = 0

    def _decode(self, content: bytes, address: Address) -> bool:
        try:
            self._frames.append(self._frame(json.loads(_plain(content))))
            return True
        except Malformed as error:
            self.counts[str(error)] += 1
        except (ValueError, RecursionError):
            self.counts["not JSON"] += 1
        return False

    def _frame(self, message: Any) -> Frame:
        if not isinstance(message, dict) or str(message.get("version", ""))[:1] != "3":
            raise Malformed("version")
        scene = message.get("scene")
        if not isinstance(scene, dict):
            raise Malformed("scene")
        actors = scene.get("actors")
        if not isinstance(actors, list) or not actors or not isinstance(actors[0], dict):
            raise Malformed("actors")
        body = actors[0].get("body")
        if not isinstance(body, dict):
            raise Malformed("body")
        bones = [bone for bone, name in NAME_OF_BONE.items() if isinstance(body.get(name), dict)]
        if not bones:
            raise Malformed("body")
        if self._skeleton.joints != tuple(bones):
            self._skeleton = skeleton_of(PARENTS, bones)
        poses = [body[NAME_OF_BONE[bone]] for bone in bones]
        positions = checks.table([_entries(pose.get("position"), "xyz") for pose in poses], len(bones), 3)
        turns = checks.table([_entries(pose.get("rotation"), "xyzw") for pose in poses], len(bones), 4)
        rotations = rotations_to_world(checks.quaternions(turns))
        stamp = checks.number(scene.get("timestamp"), MAX_STAMP_S)
        self._sequence += 1
        world = positions_to_world(positions)
        return Frame(self._skeleton, world, rotations, stamp, self._sequence, self._now)


def _plain(content: bytes) -> bytes:
    """A datagram's JSON, decompressed if need be, but never beyond its bound."""
    if not content.startswith(LZ4_MAGIC):
        return content
    unpacking = lz4.frame.LZ4FrameDecompressor()
    try:
        plain: bytes = unpacking.decompress(content, max_length=MAX_PLAIN_BYTES)
    except (RuntimeError, EOFError):
        raise Malformed("not LZ4") from None
    if not unpacking.eof:
        raise Malformed("too long")
    return plain


def _entries(value: Any, keys: str) -> list[Any]:
    if not isinstance(value, dict):
        raise Malformed("shape")
    return [value.get(key) for key in keys]


def encoded_frame(frame: Frame, compressed: bool = True) -> list[bytes]:
    """A frame of Unity's bones (`bones_of_clip`) as the datagram of the protocol, in a list."""
    assert frame.rotations is not None
    positions, turns = positions_to_unity(frame.positions), rotations_to_unity(frame.rotations)
    body = {
        NAME_OF_BONE[bone]: {
            "position": dict(zip("xyz", place.round(6).tolist(), strict=True)),
            "rotation": dict(zip("xyzw", turn.round(6).tolist(), strict=True)),
        }
        for bone, place, turn in zip(frame.skeleton.joints, positions, turns, strict=True)
    }
    actor = {"name": "person", "meta": {"hasBody": True, "hasFace": False, "hasGloves": False}, "body": body}
    message = {"version": "3,0", "fps": 60.0, "scene": {"timestamp": frame.stamp, "actors": [actor], "props": []}}
    plain = json.dumps(message, separators=(",", ":")).encode()
    return [lz4.frame.compress(plain) if compressed else plain]
