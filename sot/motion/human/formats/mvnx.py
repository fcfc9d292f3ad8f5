"""Reader of Xsens MVN's open files (.mvnx): positions and orientations of the segments, frame by frame."""

from pathlib import Path
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.formats.text import RATE_RANGE_HZ, parse_numbers

Array = NDArray[np.float64]

REST_FRAME = "identity"  # the frame of the posture in which no segment is turned
MAX_WAY_M = 1e5  # m, from the origin
MAX_NORM_ERROR = 0.05  # of a quaternion
MAX_BONE_MOVE = 0.2  # of its length: how far a segment's start may move in the segment that carries it
SHORT_BONE_M = 0.1  # m; of shorter ones that share is no measure

# The segments of MVN, each with the one that carries it, for files that do not list their joints.
CARRIED_BY = {
    "Pelvis": "",
    **dict(zip(("L5", "L3", "T12", "T8", "Neck", "Head"), ("Pelvis", "L5", "L3", "T12", "T8", "Neck"), strict=True)),
    **{
        side + segment: carrier if carrier in ("Pelvis", "T8") else side + carrier
        for side in ("Right", "Left")
        for segment, carrier in (
            ("Shoulder", "T8"),
            ("UpperArm", "Shoulder"),
            ("ForeArm", "UpperArm"),
            ("Hand", "ForeArm"),
            ("UpperLeg", "Pelvis"),
            ("LowerLeg", "UpperLeg"),
            ("Foot", "LowerLeg"),
            ("Toe", "Foot"),
        )
    },
}


def read_mvnx(path: str | Path) -> Capture:
    """Read a file of one person: its segments' starts are the joints. X forward, Z up, metres, as it stands.

    Raises:
        InputError: naming the line that cannot be read, and why; or positions and orientations that contradict
            each other, as wrong orders of quaternions do.
    """
    path = Path(path)
    found = _Document(path)
    found.parse()
    labels, parents = _tree(path, found)
    if len(found.positions) < 2:
        raise InputError(f"{path}: holds {len(found.positions)} normal frames; a motion needs at least two")
    order = [found.labels.index(label) for label in labels]
    positions = np.array(found.positions).reshape(len(found.positions), -1, 3)[:, order]
    if not np.abs(positions).max() < MAX_WAY_M:
        raise InputError(f"{path}: its segments are where no human is: the file is damaged")
    quaternions = np.array(found.orientations).reshape(len(found.positions), -1, 4)[:, order]
    norms = np.linalg.norm(quaternions, axis=2)
    if np.abs(norms - 1.0).max() > MAX_NORM_ERROR:
        raise InputError(f"{path}: its orientations are no unit quaternions")
    rotations = Rotation.from_quat(quaternions.reshape(-1, 4), scalar_first=True).as_matrix()
    rotations = rotations.reshape(*quaternions.shape[:2], 3, 3)
    _check_rigid(path, labels, parents, positions, rotations)
    zero_pose = None if found.rest is None else np.array(found.rest).reshape(-1, 3)[order]
    return Capture(path.stem, found.rate, tuple(labels), tuple(parents), positions, rotations, zero_pose)


class _Document:
    """What of a file is needed, gathered while it is parsed; nothing in it is expanded or fetched."""

    def __init__(self, path: Path):
        self.rate = 0.0
        self.labels: list[str] = []
        self.carried_by: dict[str, str] = {}
        self.positions: list[Array] = []
        self.orientations: list[Array] = []
        self.rest: tuple[float, ...] | None = None
        self._path = path
        self._parser = expat.ParserCreate(namespace_separator="}")
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._gather
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype
        self._open: list[str] = []
        self._frame: dict[str, tuple[float, ...]] | None = None
        self._kind = ""
        self._joint: dict[str, str] = {}
        self._words: list[str] | None = None
        self._subjects = 0

    def parse(self) -> None:
        """Read the file.

        Raises:
            InputError: see `read_mvnx`.
        """
        try:
            with self._path.open("rb") as stream:
                self._parser.ParseFile(stream)
        except OSError as error:
            raise InputError(f"{self._path}: cannot be read: {error.strerror}") from None
        except (expat.ExpatError, ValueError, LookupError) as error:
            raise InputError(f"{self._path}: not an MVNX, or a truncated one: {error}") from None
        if not self._subjects or not self.labels:
            raise InputError(f"{self._path}: not an MVNX: it has no subject with segments")

    @property
    def _where(self) -> str:
        return f"{self._path}, line {self._parser.CurrentLineNumber}"

    def _refuse_doctype(self, *_: object) -> None:
        raise InputError(f"{self._where}: declares a document type, which no MVNX needs: remove it")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        name = tag.rpartition("}")[2]
        inside = self._open[-1] if self._open else ""
        self._open.append(name)
        if len(self._open) == 1 and name != "mvnx":
            raise InputError(f"{self._where}: not an MVNX, which starts with <mvnx>, but <{name[:40]}>")
        if name == "subject":
            self._subjects += 1
            if self._subjects > 1:
                raise InputError(f"{self._where}: a second subject: one file holds one human")
            (self.rate,) = parse_numbers(f"{self._where}, frameRate", [attributes.get("frameRate", "")], 1)
            if not RATE_RANGE_HZ[0] <= self.rate <= RATE_RANGE_HZ[1]:
                raise InputError(f"{self._where}: {self.rate:g} frames a second are not plausible")
        elif name == "segment" and inside == "segments":
            self.labels.append(attributes.get("label", ""))
            if not self.labels[-1] or self.labels.count(self.labels[-1]) > 1:
                raise InputError(f"{self._where}: a segment needs a label of its own")
        elif name == "frame" and inside == "frames":
            self._frame, self._kind = {}, attributes.get("type", "normal")
        elif (name in ("position", "orientation") and inside == "frame") or name.startswith("connector"):
            self._words = []

    def _gather(self, text: str) -> None:
        if self._words is not None:
            self._words.append(text)

    def _end(self, tag: str) -> None:
        name = self._open.pop()
        text = "".join(self._words or ())
        if name.startswith("connector"):
            self._joint[name] = text.partition("/")[0].strip()
        elif name == "joint":
            carrier, carried = (self._joint.get(f"connector{k}", "") for k in (1, 2))
            self.carried_by[carried] = carrier
            self._joint = {}
        elif self._frame is not None and name in ("position", "orientation") and self._words is not None:
            width = len(self.labels) * (3 if name == "position" else 4)
            self._frame[name] = parse_numbers(f"{self._where}, {name}", text.split(), width)
        elif name == "frame" and self._frame is not None:
            self._end_frame(self._frame)
            self._frame = None
        self._words = None

    def _end_frame(self, frame: dict[str, tuple[float, ...]]) -> None:
        if self._kind == "normal":
            if missing := [name for name in ("position", "orientation") if name not in frame]:
                raise InputError(f"{self._where}: a frame without {missing[0]}: export them too")
            self.positions.append(np.array(frame["position"]))
            self.orientations.append(np.array(frame["orientation"]))
        elif self._kind == REST_FRAME:
            self.rest = frame.get("position", self.rest)


def _tree(path: Path, found: _Document) -> tuple[list[str], list[int]]:
    """Labels of the segments, carriers first, and the index of each one's carrier."""
    carriers = found.carried_by if found.carried_by else CARRIED_BY
    children: dict[str, list[str]] = {}
    for label in found.labels:
        children.setdefault(carriers.get(label, ""), []).append(label)
    roots = children.get("", [])
    if len(roots) != 1:
        raise InputError(f"{path}: {' and '.join(roots[:3]) or 'none'} of its segments hang on no other; one must")
    order = [roots[0]]
    for label in order:  # grows on the way
        order.extend(children.get(label, []))
    if lost := [label for label in found.labels if label not in order]:
        raise InputError(f"{path}: its joints do not lead to the segment '{lost[0]}'")
    return order, [-1, *(order.index(carriers[label]) for label in order[1:])]


def _check_rigid(path: Path, labels: list[str], parents: list[int], positions: Array, rotations: Array) -> None:
    """Check that each segment starts at the same place of the one that carries it."""
    for joint, parent in enumerate(parents):
        if parent < 0:
            continue
        place = np.einsum("tji,tj->ti", rotations[:, parent], positions[:, joint] - positions[:, parent])
        middle = np.median(place, axis=0)
        moves = np.median(np.linalg.norm(place - middle, axis=1))
        if moves > MAX_BONE_MOVE * max(float(np.linalg.norm(middle)), SHORT_BONE_M):
            raise InputError(
                f"{path}: {labels[joint]} does not stay on {labels[parent]}: positions and orientations contradict each"
                " other; are quaternions in the order w, x, y, z, and nothing mirrored?"
            )
