"""Reader of Biovision hierarchies (.bvh)."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.formats.text import AXES, RATE_RANGE_HZ, parse_numbers, read_lines, rotate_about_own_axis

MISSING_FRAMES_ALLOWED = 2  # a header may promise so many too many: converters that drop a frame forget to count again


@dataclass
class _Joint:
    name: str
    parent: int
    offset: tuple[float, ...] | None = None
    channels: list[str] = field(default_factory=list)


def read_bvh(path: str | Path) -> Capture:
    """Read a .bvh file as it stands: its own unit and axes, every frame.

    Channels may come in any number and order on each joint; a position channel replaces that component of OFFSET, and
    the angles that SOMA writes behind an OFFSET are of a pose that is not needed. The frame count in the header is not
    trusted: all the frames there are get read.

    Raises:
        InputError: naming the file and line that cannot be read, and why.
    """
    path = Path(path)
    lines = _read_bvh_lines(path)
    joints, motion_line = _parse_hierarchy(path, lines)
    rate, first, promised = _parse_motion_header(path, lines, motion_line)
    values = _parse_frames(path, lines, first, promised, sum(len(joint.channels) for joint in joints))
    positions, rotations = _forward_kinematics(joints, values)
    return Capture(
        name=path.stem,
        rate=rate,
        joints=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        positions=positions,
        rotations=rotations,
        zero_pose=_forward_kinematics(joints, np.zeros((1, values.shape[1])))[0][0],
    )


def _read_bvh_lines(path: Path) -> list[str]:
    lines = read_lines(path, "a BVH")
    first = next((i for i, line in enumerate(lines) if line.strip()), 0)
    if lines[first].split()[:1] != ["HIERARCHY"]:
        raise InputError(f"{path}, line {first + 1}: not a BVH, which starts with HIERARCHY")
    return lines


def _numbered_words(lines: list[str]) -> Iterator[tuple[int, list[str]]]:
    """Line numbers with the words of each line; a brace counts as a line of its own."""
    for number, line in enumerate(lines, start=1):
        for part in line.replace("{", "\n{\n").replace("}", "\n}\n").split("\n"):
            if words := part.split():
                yield number, words


def _parse_hierarchy(path: Path, lines: list[str]) -> tuple[list[_Joint], int]:
    """The joints, parents first, and the number of the line that says MOTION."""
    joints: list[_Joint] = []
    open_joints: list[int] = []
    pending = False  # a joint is named and its brace must follow
    for number, words in _numbered_words(lines):
        where, key = f"{path}, line {number}", words[0].upper()
        if pending and key != "{":
            raise InputError(f"{where}: expected '{{' after the name of a joint, found '{words[0]}'")
        if key == "HIERARCHY" and not joints:
            continue
        if key == "{" and pending:
            open_joints.append(len(joints) - 1)
            pending = False
        elif key in ("ROOT", "JOINT", "END"):
            joints.append(_new_joint(where, key, words, joints, open_joints))
            pending = True
        elif key == "}" and open_joints:
            closed = joints[open_joints.pop()]
            if closed.offset is None:
                raise InputError(f"{where}: joint '{closed.name}' has no OFFSET")
        elif key == "OFFSET" and open_joints:
            joints[open_joints[-1]].offset = parse_numbers(where, words[1:], 6 if len(words) == 7 else 3)[:3]
        elif key == "CHANNELS" and open_joints:
            joints[open_joints[-1]].channels = _parse_channels(where, words[1:])
        elif key == "MOTION" and joints and not open_joints:
            return joints, number
        else:
            raise InputError(f"{where}: '{words[0]}' does not belong here in a BVH hierarchy")
    raise InputError(f"{path}, line {len(lines)}: the file ends before MOTION; it is truncated")


def _new_joint(where: str, key: str, words: list[str], joints: list[_Joint], open_joints: list[int]) -> _Joint:
    if (key == "ROOT") != (not joints):
        raise InputError(f"{where}: one ROOT is expected before all else and only there; one file holds one human")
    if key != "ROOT" and not open_joints:
        raise InputError(f"{where}: '{' '.join(words)}' lies outside of the root joint")
    parent = open_joints[-1] if open_joints else -1
    names = {joint.name for joint in joints}
    if key == "END":
        name, count = f"{joints[parent].name}_end", 1
        while name in names:
            count += 1
            name = f"{joints[parent].name}_end{count}"
    else:
        name = " ".join(words[1:])
    if not name:
        raise InputError(f"{where}: a joint without a name")
    if name in names:
        raise InputError(f"{where}: a second joint is named '{name}'; rename one of them")
    return _Joint(name, parent)


def _parse_channels(where: str, words: list[str]) -> list[str]:
    channels = [word.lower().capitalize() for word in words[1:]]
    known = {axis + kind for axis in AXES for kind in ("position", "rotation")}
    if unknown := [word for word in channels if word not in known]:
        raise InputError(f"{where}: unknown channel '{unknown[0]}'; known are Xposition, Xrotation and so on")
    if words[:1] != [str(len(channels))]:
        raise InputError(f"{where}: CHANNELS says '{' '.join(words[:1])}' but names {len(channels)}")
    if len(set(channels)) != len(channels):
        raise InputError(f"{where}: a channel is named twice")
    return channels


def _parse_motion_header(path: Path, lines: list[str], motion_line: int) -> tuple[float, int, int]:
    """Frames per second, the index of the first line of frames, and the number of frames promised."""
    found: dict[str, float] = {}
    for index in range(motion_line, len(lines)):
        if not lines[index].strip():
            continue
        where = f"{path}, line {index + 1}"
        key, colon, value = lines[index].partition(":")
        key = " ".join(key.lower().split())
        if not colon or key not in ("frames", "frame time"):
            raise InputError(f"{where}: expected 'Frames:' and 'Frame Time:' after MOTION")
        (found[key],) = parse_numbers(where, value.split(), 1)
        if key == "frame time":
            seconds = found[key]
            if seconds <= 0.0 or not RATE_RANGE_HZ[0] <= 1.0 / seconds <= RATE_RANGE_HZ[1]:
                raise InputError(
                    f"{where}: a frame time of {seconds:g} s is not plausible;"
                    f" expected {1 / RATE_RANGE_HZ[1]:g} to {1 / RATE_RANGE_HZ[0]:g} s"
                )
        if len(found) == 2:
            return _rate_from_frame_time(found["frame time"]), index + 1, int(found["frames"])
    raise InputError(f"{path}, line {len(lines)}: the file ends before its frames; it is truncated")


def _rate_from_frame_time(frame_time: float) -> float:
    """Frames per second; a whole number where only the rounding of the frame time stands against it."""
    rate = 1.0 / frame_time
    return float(round(rate)) if abs(rate - round(rate)) < 1e-4 * rate else rate


def _parse_frames(path: Path, lines: list[str], first: int, promised: int, count: int) -> np.ndarray:
    """(T, count) channel values."""
    rows: list[list[float]] = []
    for number, line in enumerate(lines[first:], start=first + 1):
        words = line.split()
        if not words:
            continue
        if len(words) != count:
            raise InputError(f"{path}, line {number}: expected {count} numbers, found {len(words)}; is it truncated?")
        try:
            row = list(map(float, words))
        except ValueError as error:
            raise InputError(f"{path}, line {number}: not a number: {str(error).rpartition(': ')[2]}") from error
        if not math.isfinite(math.fsum(map(abs, row))):
            raise InputError(f"{path}, line {number}: a value is not finite")
        rows.append(row)
    if len(rows) < 2:
        raise InputError(f"{path}: holds {len(rows)} frames; a motion needs at least two")
    if len(rows) < promised - MISSING_FRAMES_ALLOWED:
        raise InputError(
            f"{path}, line {len(lines)}: ends after {len(rows)} of {promised} frames; it is truncated"
            " (if it is complete, mend its 'Frames:' line)"
        )
    return np.array(rows)


def _forward_kinematics(joints: list[_Joint], values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Global positions (T, J, 3) and rotations (T, J, 3, 3) from channel values (T, C) in degrees."""
    count = len(values)
    positions = np.empty((len(joints), count, 3))
    rotations = np.empty((len(joints), count, 3, 3))
    angles = np.radians(values)
    column = 0
    for index, joint in enumerate(joints):
        local = np.tile(np.asarray(joint.offset), (count, 1))
        rotation = np.tile(np.eye(3), (count, 1, 1)) if joint.parent < 0 else rotations[joint.parent].copy()
        parent_rotation = rotation.copy()
        for channel in joint.channels:
            axis = AXES.index(channel[0])
            if channel.endswith("position"):
                local[:, axis] = values[:, column]
            else:
                rotate_about_own_axis(rotation, axis, angles[:, column])
            column += 1
        rotations[index] = rotation
        if joint.parent < 0:
            positions[index] = local
        else:
            positions[index] = positions[joint.parent] + np.einsum("tij,tj->ti", parent_rotation, local)
    return positions.transpose(1, 0, 2), rotations.transpose(1, 0, 2, 3)
