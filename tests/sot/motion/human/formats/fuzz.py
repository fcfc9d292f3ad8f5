"""Seeded damage to files of every format: bytes that are lost, doubled, changed or taken from elsewhere."""

import io
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from sot.motion.human.skeleton import naming_conventions
from tests.sot.motion.human.clips import short_groove
from tests.sot.motion.human.formats.dance import dance
from tests.sot.motion.human.formats.writers import amass_arrays, c3d_bytes, markers, mvnx_text

FRAMES = 12
ENDINGS = ("bvh", "amc", "c3d", "mvnx", "npz", "toml")
STRANGE = (
    b"nan",
    b"-inf",
    b"1e308",
    b"1e9",
    b"-1",
    b"0",
    b"",
    b"{",
    b"}",
    b"\0",
    b"\xff\xfe",
    b'"',
    b"<",
    b"&amp;",
    b"999999999999",
)

ASF = """:version 1.10
:name someone
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
{bones}
:hierarchy
  begin
{tree}
  end
"""
_BONES = (  # name, direction, length [inch / 0.45], the bone at whose end it starts
    ("lhipjoint", "1 -0.6 0", 2.0, "root"),
    ("lfemur", "0 -1 0", 7.5, "lhipjoint"),
    ("ltibia", "0 -1 0", 7.3, "lfemur"),
    ("lfoot", "0 -0.5 1", 2.4, "ltibia"),
    ("ltoes", "0 0 1", 1.1, "lfoot"),
    ("lowerback", "0 1 0", 2.0, "root"),
    ("upperback", "0 1 0", 2.0, "lowerback"),
    ("thorax", "0 1 0", 2.0, "upperback"),
    ("lowerneck", "0 1 0", 2.7, "thorax"),
    ("head", "0 1 0", 2.7, "lowerneck"),
    ("lclavicle", "1 0.8 0", 3.2, "thorax"),
    ("lhumerus", "0.2 -1 0", 5.0, "lclavicle"),
    ("lradius", "0 -1 0.1", 3.2, "lhumerus"),
    ("lwrist", "0 -1 0", 1.7, "lradius"),
)


def acclaim_texts() -> tuple[str, str]:
    """A skeleton of our own and a motion of it: it sways, and bends its knees and arms."""
    bones = [*_BONES]
    for name, direction, length, above in _BONES:
        if name[0] == "l" and name not in ("lowerback", "lowerneck"):
            x, rest = direction.split(" ", 1)
            over = "r" + above[1:] if above not in ("root", "thorax") else above
            bones.append(("r" + name[1:], f"{-float(x):g} {rest}", length, over))
    blocks = [
        f"  begin\n     id {k}\n     name {name}\n     direction {direction}\n     length {length}\n"
        "     axis 0 0 0 XYZ\n    dof rx ry rz\n  end"
        for k, (name, direction, length, _) in enumerate(bones, 1)
    ]
    tree = "\n".join(f"    {above} {name}" for name, _, _, above in bones)
    frames = []
    for t in range(FRAMES):
        sway = np.sin(0.5 * t)
        turned = {
            "femur": -20.0 - 5.0 * sway,
            "tibia": 40.0 + 10.0 * sway,
            "foot": -20.0,
            "radius": -30.0 - 10.0 * sway,
        }
        values = [f"{name} {turned.get(name[1:], 0.0):.4f} {sway:.4f} 0.0" for name, _, _, _ in bones]
        frames.append(f"{t + 1}\nroot {0.1 * sway:.4f} 16.5 0 0 {3 * sway:.4f} 0\n" + "\n".join(values))
    return ASF.format(bones="\n".join(blocks), tree=tree), ":FULLY-SPECIFIED\n:DEGREES\n" + "\n".join(frames) + "\n"


@cache
def whole_file(ending: str) -> bytes:
    """A small sound file of a format, a mapping of the shipped clip's joints for "toml"."""
    if ending == "bvh":
        return short_groove(FRAMES, 150).encode()
    if ending == "amc":
        return acclaim_texts()[1].encode()
    if ending == "c3d":
        return c3d_bytes(markers(dance(FRAMES)), 50.0)
    if ending == "mvnx":
        return mvnx_text(dance(FRAMES)).encode()
    if ending == "npz":
        file = io.BytesIO()
        np.savez(file, **amass_arrays(dance(FRAMES)))
        return file.getvalue()
    names = naming_conventions()["motionbuilder"]
    return "".join(f'{joint} = "{aliases[0]}"\n' for joint, aliases in names.items()).encode()


def damaged_file(folder: Path, ending: str, seed: int) -> tuple[Path, Path | None]:
    """A clip with one to four damages, and its mapping where that is what is damaged; with what belongs to it."""
    random = np.random.default_rng([ENDINGS.index(ending), seed])
    data = whole_file(ending)
    skeleton = acclaim_texts()[0].encode()
    in_skeleton = ending == "amc" and random.random() < 0.4
    if ending == "npz" and random.random() < 0.7:  # what the archive's check sums do not find
        damaged = _with_damaged_array(data, random)
    else:
        damaged = _damaged(skeleton if in_skeleton else data, random)
    if ending == "toml":
        (folder / "clip.bvh").write_bytes(whole_file("bvh"))
        (folder / "mapping.toml").write_bytes(damaged)
        return folder / "clip.bvh", folder / "mapping.toml"
    if ending == "amc":
        (folder / "clip.asf").write_bytes(damaged if in_skeleton else skeleton)
        damaged = data if in_skeleton else damaged
    path = folder / f"clip.{ending}"
    path.write_bytes(damaged)
    return path, None


def _damaged(data: bytes, random: np.random.Generator) -> bytes:
    for _ in range(int(random.integers(1, 5))):
        if data:
            data = DAMAGES[int(random.integers(len(DAMAGES)))](data, random)
    return data


def _with_damaged_array(data: bytes, random: np.random.Generator) -> bytes:
    """A file of arrays with one of them damaged, and sound check sums."""
    with zipfile.ZipFile(io.BytesIO(data)) as file:
        arrays = {name: file.read(name) for name in file.namelist()}
    name = sorted(arrays)[int(random.integers(len(arrays)))]
    arrays[name] = _damaged(arrays[name], random)
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w") as file:
        for name, content in arrays.items():
            file.writestr(name, content)
    return written.getvalue()


def _place(data: bytes, random: np.random.Generator) -> int:
    """A place in a file: half of the times in its first part, where what it says about itself stands."""
    return int(random.integers(min(len(data), 1200) if random.random() < 0.5 else len(data)))


def cut_off(data: bytes, random: np.random.Generator) -> bytes:
    return data[: _place(data, random)]


def changed_bytes(data: bytes, random: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for _ in range(int(random.integers(1, 9))):
        changed[_place(data, random)] = int(random.integers(256))
    return bytes(changed)


def lost_part(data: bytes, random: np.random.Generator) -> bytes:
    at = _place(data, random)
    return data[:at] + data[at + int(random.integers(1, 200)) :]


def doubled_part(data: bytes, random: np.random.Generator) -> bytes:
    at = _place(data, random)
    size = int(random.integers(1, 400))
    return data[: at + size] + data[at : at + size] + data[at + size :]


def moved_part(data: bytes, random: np.random.Generator) -> bytes:
    one, other = _place(data, random), _place(data, random)
    size = int(random.integers(1, 60))
    return data[:other] + data[one : one + size] + data[other + size :]


def strange_word(data: bytes, random: np.random.Generator) -> bytes:
    words = data.split(b" ")
    words[int(random.integers(len(words)))] = STRANGE[int(random.integers(len(STRANGE)))]
    return b" ".join(words)


def changed_digit(data: bytes, random: np.random.Generator) -> bytes:
    digits = [k for k in range(_place(data, random), len(data)) if 48 <= data[k] <= 57][:200]
    if not digits:
        return data
    at = digits[int(random.integers(len(digits)))]
    return data[:at] + bytes([int(random.integers(48, 58))]) * int(random.integers(1, 8)) + data[at + 1 :]


DAMAGES: tuple[Callable[[bytes, np.random.Generator], bytes], ...] = (
    cut_off,
    changed_bytes,
    lost_part,
    doubled_part,
    moved_part,
    strange_word,
    changed_digit,
)
