"""Reader of Acclaim's files: a skeleton (.asf) and its motion (.amc)."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.formats.text import AXES, RATE_RANGE_HZ, parse_numbers, read_lines, rotate_about_own_axis

DEFAULT_RATE_HZ = 120.0  # Hz, of CMU's and most other files, which do not say it
ROOT = "root"
RADIANS_PER_DEGREE = math.pi / 180.0

Line = tuple[str, list[str]]
"""Where it is, for messages, and its words."""


@dataclass(frozen=True)
class _Bone:
    """A bone whose start is a joint.

    Attributes:
        name: unique.
        parent: index of the bone at whose end it starts, -1 for the root.
        offset: (3,) from its start to its end where nothing is turned, in the file's axes and unit.
        axes: (3, 3) from the axes of its joint to the file's, there.
        channels: "rx" and so on, in the order of its values, and of the turns, about axes that stay.
    """

    name: str
    parent: int
    offset: np.ndarray
    axes: np.ndarray
    channels: tuple[str, ...]


def read_acclaim(path: str | Path) -> Capture:
    """Read a motion (.amc) with its skeleton (.asf), or a skeleton with its motion, in the file's own unit and axes.

    The other file is found beside the given one: of the same name, or a skeleton with whose name that of the motion
    begins, or the only one there. A joint has the name of the bone that starts there. Lengths stay as they are
    written: `length` of the skeleton's units is a factor to some programs and a divisor to others. Without
    `:samples-per-second` the rate is taken to be DEFAULT_RATE_HZ.

    Raises:
        InputError: naming the file and line that cannot be read, and why; or no other file, or several.
    """
    skeleton, motion = _skeleton_and_motion_files(Path(path))
    bones, turn = _parse_skeleton(skeleton)
    rate, values = _parse_motion(motion, skeleton, bones, turn)
    leaves = sorted(set(range(len(bones))) - {bone.parent for bone in bones})
    positions, rotations = _with_ends(bones, leaves, values)
    return Capture(
        name=motion.stem,
        rate=rate,
        joints=(*(bone.name for bone in bones), *(f"{bones[leaf].name}_end" for leaf in leaves)),
        parents=(*(bone.parent for bone in bones), *leaves),
        positions=positions,
        rotations=rotations,
        zero_pose=_with_ends(bones, leaves, np.zeros((1, values.shape[1])))[0][0],
    )


def _with_ends(bones: Sequence[_Bone], leaves: Sequence[int], values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (T, J, 3) and rotations (T, J, 3, 3) of the bones' starts and of the ends of the last bones."""
    positions, rotations = _forward_kinematics(bones, values)
    ends = positions[leaves] + np.stack([np.einsum("tij,j->ti", rotations[i], bones[i].offset) for i in leaves])
    return (
        np.concatenate([positions, ends]).transpose(1, 0, 2),
        np.concatenate([rotations, rotations[leaves]]).transpose(1, 0, 2, 3),
    )


def _skeleton_and_motion_files(path: Path) -> tuple[Path, Path]:
    """The files of the skeleton (.asf) and of the motion (.amc), of which one is given."""
    given = path.suffix.lower()
    wanted = ".amc" if given == ".asf" else ".asf"
    if not path.is_file():
        raise InputError(f"{path}: cannot be read: No such file")
    beside = sorted(other for other in path.parent.iterdir() if other.suffix.lower() == wanted)
    what = "motion" if wanted == ".amc" else "skeleton"
    if not beside:
        raise InputError(f"{path}: its {what} ({wanted}) is missing: put it into the same folder")
    named = [other for other in beside if other.stem == path.stem]
    if not named and wanted == ".asf":
        named = [other for other in beside if path.stem.startswith(other.stem)]
        named = [other for other in named if len(other.stem) == max(len(one.stem) for one in named)]
    chosen = named or beside
    if len(chosen) > 1:
        names = ", ".join(other.name for other in chosen[:3])
        advice = "give one of them instead" if wanted == ".amc" else f"name its own {path.stem}.asf"
        raise InputError(f"{path}: which {what} is meant, {names}{' …' if len(chosen) > 3 else ''}? {advice}")
    return (path, chosen[0]) if given == ".asf" else (chosen[0], path)


def _numbered_words(path: Path, kind: str) -> Iterator[Line]:
    """Words of each line that has any; comments, commas and parentheses count as space."""
    plain = str.maketrans("(),", "   ")
    for number, line in enumerate(read_lines(path, kind), start=1):
        if words := line.partition("#")[0].translate(plain).split():
            yield f"{path}, line {number}", words


def _parse_skeleton(path: Path) -> tuple[list[_Bone], float]:
    """The bones, parents first, and the angle [rad] that a motion counts in unless it says otherwise."""
    sections: dict[str, list[Line]] = {}
    lines: list[Line] = []
    for where, words in _numbered_words(path, "an ASF"):
        if words[0].startswith(":"):
            lines = sections.setdefault(words[0].lower(), [])
        elif not sections:
            raise InputError(f"{where}: not an ASF, which starts with a keyword like :version")
        else:
            lines.append((where, words))
    if missing := [name for name in (":root", ":bonedata", ":hierarchy") if not sections.get(name)]:
        raise InputError(f"{path}: has no {missing[0]}: no ASF, or a truncated one")
    units = {words[0].lower(): words[1:] for _, words in sections.get(":units", [])}
    turn = 1.0 if units.get("angle", ["deg"])[:1] == ["rad"] else RADIANS_PER_DEGREE
    described = {ROOT: _parse_root(path, dict(_keyword_fields(sections[":root"])))}
    for where, fields in _begin_end_blocks(path, sections[":bonedata"]):
        bone = _parse_bone(where, fields, turn)
        if bone.name in described:
            raise InputError(f"{where}: a second bone is named '{bone.name}'")
        described[bone.name] = bone
    return _bones_parents_first(path, _begin_end_blocks(path, sections[":hierarchy"]), described), turn


def _keyword_fields(lines: Sequence[Line]) -> Iterator[tuple[str, Line]]:
    """Each line's keyword and the words after it; further lines of limits, which begin with a number, do no harm."""
    for where, words in lines:
        yield words[0].lower(), (where, words[1:])


def _begin_end_blocks(path: Path, lines: Sequence[Line]) -> list[tuple[str, list[Line]]]:
    """The lines between each begin and end, with the place where each block begins."""
    blocks: list[tuple[str, list[Line]]] = []
    begun = False
    for where, words in lines:
        key = words[0].lower()
        if key == ("end" if begun else "begin"):
            begun = not begun
            if begun:
                blocks.append((where, []))
        elif not begun or key == "begin":
            raise InputError(f"{where}: '{words[0]}' does not belong here: between begin and end stands one thing")
        else:
            blocks[-1][1].append((where, words))
    if begun:
        raise InputError(f"{path}: what begins at {blocks[-1][0].rpartition(', ')[2]} has no end; it is truncated")
    return blocks


def _parse_root(path: Path, fields: Mapping[str, Line]) -> _Bone:
    """The root bone. Its preset position does not matter, since a capture is moved to the origin later."""
    if "order" not in fields:
        raise InputError(f"{path}: its :root has no order")
    if "orientation" in fields and any(parse_numbers(*fields["orientation"], 3)):
        raise InputError(f"{fields['orientation'][0]}: programs differ in what a turned root means; make it 0 0 0")
    return _Bone(ROOT, -1, np.zeros(3), np.eye(3), _parse_channels(*fields["order"], "tr"))


def _parse_bone(where: str, lines: Sequence[Line], turn: float) -> _Bone:
    """A bone without a parent yet; turn: the unit of its angles [rad]."""
    fields = dict(_keyword_fields(lines))
    name = " ".join(fields.get("name", ("", []))[1])
    if missing := [key for key in ("name", "direction", "length", "axis") if key not in fields or not name]:
        raise InputError(f"{where}: the bone that begins here has no {missing[0]}")
    direction = np.array(parse_numbers(*fields["direction"], 3))
    (length,) = parse_numbers(*fields["length"], 1)
    size = float(np.linalg.norm(direction))
    if length < 0.0 or (length and not size):
        raise InputError(f"{where}: bone '{name}' needs a length of at least 0, and a direction")
    at, words = fields["axis"]
    angles, order = parse_numbers(at, words[:3], 3), "".join(words[3:]).upper()
    if sorted(order) != list(AXES):
        raise InputError(
            f"{at}: expected three angles and the order of their axes, like XYZ, found '{' '.join(words)}'"
        )
    axes = np.eye(3)[None]
    for letter in reversed(order):  # the first is turned about first, and the axes stay: from the right, the last
        rotate_about_own_axis(axes, AXES.index(letter), np.array([turn * angles[AXES.index(letter)]]))
    channels = _parse_channels(*fields["dof"], "r") if "dof" in fields else ()
    return _Bone(name, -1, direction * (length / size if size else 0.0), axes[0], channels)


def _parse_channels(where: str, words: Sequence[str], kinds: str) -> tuple[str, ...]:
    channels = tuple(word.lower() for word in words)
    known = [kind + axis.lower() for kind in kinds for axis in AXES]
    if unknown := [word for word in channels if word not in known]:
        raise InputError(f"{where}: '{unknown[0]}' cannot be read here, where {', '.join(known)} can")
    if len(set(channels)) != len(channels):
        raise InputError(f"{where}: a degree of freedom is named twice")
    return channels


def _bones_parents_first(
    path: Path, blocks: Sequence[tuple[str, list[Line]]], described: Mapping[str, _Bone]
) -> list[_Bone]:
    """The bones in the order of the hierarchy, parents first."""
    parents: dict[str, str] = {}
    children: dict[str, list[str]] = {name: [] for name in described}
    for where, (parent, *own) in ((at, words) for _, lines in blocks for at, words in lines):
        for name in (parent, *own):
            if name not in described:
                raise InputError(f"{where}: no bone is named '{name}'")
        for name in own:
            if name == ROOT or name in parents:
                raise InputError(f"{where}: '{name}' starts at one bone's end only")
            parents[name] = parent
            children[parent].append(name)
    order = [ROOT]
    for name in order:  # grows on the way
        order.extend(children[name])
    if lost := [name for name in described if name not in order]:
        raise InputError(f"{path}: its :hierarchy does not lead from the root to '{lost[0]}'")
    index = {name: i for i, name in enumerate(order)}
    return [replace(described[name], parent=index[parents[name]] if name in parents else -1) for name in order]


def _parse_motion(path: Path, skeleton: Path, bones: Sequence[_Bone], turn: float) -> tuple[float, np.ndarray]:
    """Frames per second, and the values (T, C) of all channels, bone by bone, angles in radians."""
    rate, rows = DEFAULT_RATE_HZ, _FrameBuilder(path, skeleton, bones)
    for where, words in _numbered_words(path, "an AMC"):
        key = words[0].lower()
        if key in (":degrees", ":radians"):
            turn = 1.0 if key == ":radians" else RADIANS_PER_DEGREE
        elif key == ":samples-per-second":
            (rate,) = parse_numbers(where, words[1:], 1)
            if not RATE_RANGE_HZ[0] <= rate <= RATE_RANGE_HZ[1]:
                raise InputError(f"{where}: {rate:g} frames a second are not plausible")
        elif len(words) == 1 and key.isdigit():
            rows.begin_frame(where, int(key))
        elif not key.startswith(":"):
            rows.add_bone_values(where, words)
    values = rows.channel_values()
    turned = [channel[0] == "r" for bone in bones for channel in bone.channels]
    values[:, turned] *= turn
    return rate, values


class _FrameBuilder:
    """Builder of a motion's frames, filled line by line."""

    def __init__(self, path: Path, skeleton: Path, bones: Sequence[_Bone]):
        self._path, self._skeleton = path, skeleton
        self._bones = {bone.name: bone for bone in bones}
        ends = np.cumsum([len(bone.channels) for bone in bones]).tolist()
        self._columns = {b.name: slice(end - len(b.channels), end) for b, end in zip(bones, ends, strict=True)}
        self._moved = {bone.name for bone in bones if bone.channels}
        self._width = ends[-1]
        self._rows: list[list[float]] = []
        self._number = 0
        self._missing: set[str] = set()

    def begin_frame(self, where: str, number: int) -> None:
        self._check_frame_complete()
        if self._rows and number != self._number + 1:
            raise InputError(f"{where}: frame {number} follows frame {self._number}; some are missing")
        self._number, self._missing = number, set(self._moved)
        self._rows.append([0.0] * self._width)

    def add_bone_values(self, where: str, words: Sequence[str]) -> None:
        name = words[0]
        bone = self._bones.get(name)
        if not self._rows:
            raise InputError(f"{where}: not an AMC, which holds the number of a frame before '{name}'")
        if bone is None:
            raise InputError(
                f"{where}: '{name}' is no bone of {self._skeleton.name}; is it the skeleton of this motion?"
            )
        if len(words) - 1 != len(bone.channels):
            wanted = f"{len(bone.channels)} numbers ({' '.join(bone.channels)})" if bone.channels else "no numbers"
            raise InputError(f"{where}: '{name}' needs {wanted} and has {len(words) - 1}; is it truncated?")
        if name not in self._missing and bone.channels:
            raise InputError(f"{where}: '{name}' stands twice in frame {self._number}")
        self._missing.discard(name)
        self._rows[-1][self._columns[name]] = parse_numbers(where, words[1:], len(bone.channels))

    def channel_values(self) -> np.ndarray:
        """(T, C) values."""
        self._check_frame_complete()
        if len(self._rows) < 2:
            raise InputError(f"{self._path}: holds {len(self._rows)} frames; a motion needs at least two")
        return np.array(self._rows)

    def _check_frame_complete(self) -> None:
        if lacking := [name for name in self._bones if name in self._missing]:
            frame = f"{self._path}: frame {self._number}"
            raise InputError(f"{frame} holds nothing for {len(lacking)} bones, '{lacking[0]}' first; is it truncated?")


def _forward_kinematics(bones: Sequence[_Bone], values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (B, T, 3) of the bones' starts and their rotations (B, T, 3, 3) from values (T, C) in radians.

    With C a joint's axes and M its turns, a bone turns by C M Cᵀ against its parent, and starts at the parent's end.
    """
    positions, rotations = np.zeros((len(bones), len(values), 3)), np.empty((len(bones), len(values), 3, 3))
    column = 0
    for index, bone in enumerate(bones):
        if bone.parent < 0:
            rotation = np.tile(bone.axes, (len(values), 1, 1))
        else:
            above, rotation = bones[bone.parent], rotations[bone.parent] @ bone.axes
            along = np.einsum("tij,j->ti", rotations[bone.parent], above.offset)
            positions[index] = positions[bone.parent] + along
        own = list(zip(bone.channels, values[:, column : column + len(bone.channels)].T, strict=True))
        for channel, value in reversed(own):
            axis = AXES.lower().index(channel[1])
            if channel[0] == "r":
                rotate_about_own_axis(rotation, axis, value)
            else:
                positions[index][:, axis] = value
        rotations[index] = rotation @ bone.axes.T
        column += len(bone.channels)
    return positions, rotations
