"""Seeded damage to a small clip: what files from other programs, cut downloads and lost trackers look like."""

import re
from collections.abc import Callable

import numpy as np

from tests.sot.motion.human.clips import short_groove

Mutation = Callable[[str, np.random.Generator], str]

FRAMES = 40
STRANGE = ["nan", "inf", "-inf", "1e308", "-1e9", "1e-300", "0", "90", "360", "100000", "x", "", "1,5", "--3"]


def mutated_clip(seed: int) -> tuple[str, str]:
    """The names of one to three mutations, and the shipped clip's first frames after them."""
    random = np.random.default_rng(seed)
    text = short_groove(FRAMES, first=100)
    names = [MUTATIONS[k].__name__ for k in random.choice(len(MUTATIONS), random.integers(1, 4))]
    for name in names:
        text = globals()[name](text, random)
    return " ".join(names), text


def _values(text: str) -> tuple[str, np.ndarray]:
    head, _, motion = text.partition("MOTION\n")
    rows = [line.split() for line in motion.splitlines()[2:]]
    try:
        values = np.array(rows, dtype=float)
    except ValueError:
        return text, np.zeros((0, 0))
    return head, values if values.ndim == 2 else np.zeros((0, 0))


def _with_values(text: str, change: Callable[[np.ndarray], np.ndarray]) -> str:
    """The clip with its channel values (T, C) changed; as it is where an earlier mutation left none."""
    head, values = _values(text)
    if not values.size:
        return text
    values = change(values)
    rows = [" ".join(f"{value:.6g}" for value in row) for row in values]
    rate = re.search(r"Frame Time:.*", text)
    return "\n".join([head + "MOTION", f"Frames: {len(rows)}", rate[0] if rate else "Frame Time: 0.02", *rows, ""])


def cut_off(text: str, random: np.random.Generator) -> str:
    """The file ends somewhere."""
    return text[: random.integers(1, len(text))]


def strange_word(text: str, random: np.random.Generator) -> str:
    """A word is something else."""
    words = re.split(r"(\s+)", text)
    words[2 * int(random.integers(len(words) // 2))] = str(random.choice(STRANGE))
    return "".join(words)


def strange_number(text: str, random: np.random.Generator) -> str:
    """A value of the motion is something else."""
    start = text.find("Frame Time")
    words = re.split(r"(\s+)", text[start:])
    if len(words) > 8:
        words[2 * int(random.integers(3, len(words) // 2))] = str(random.choice(STRANGE))
    return text[:start] + "".join(words)


def frame_time(text: str, random: np.random.Generator) -> str:
    """The frame time is another."""
    value = random.choice(["0", "-0.02", "nan", "1e9", "1e-9", "0.2", "0.005", "0.0005"])
    return re.sub(r"Frame Time:.*", f"Frame Time: {value}", text)


def frame_count(text: str, random: np.random.Generator) -> str:
    """The count of frames is another."""
    return re.sub(r"Frames:.*", f"Frames: {random.choice([-1, 0, 1, 39, 41, 1000, 10**12])}", text)


def few_frames(text: str, random: np.random.Generator) -> str:
    """Of all frames only a few are there."""
    keep = int(random.integers(0, 6))
    return _with_values(text, lambda values: values[:keep])


def frozen(text: str, random: np.random.Generator) -> str:
    """All frames are the first."""
    return _with_values(text, lambda values: np.repeat(values[:1], len(values), axis=0))


def zeroed(text: str, random: np.random.Generator) -> str:
    """All channels, or a run of them, are zero."""

    def change(values: np.ndarray) -> np.ndarray:
        first = int(random.integers(values.shape[1]))
        values[:, first : first + int(random.integers(1, values.shape[1] + 1))] = 0.0
        return values

    return _with_values(text, change)


def huge(text: str, random: np.random.Generator) -> str:
    """A channel is much too large, in one frame or in all."""

    def change(values: np.ndarray) -> np.ndarray:
        rows = slice(None) if random.random() < 0.5 else int(random.integers(len(values)))
        values[rows, int(random.integers(values.shape[1]))] *= 10.0 ** random.integers(1, 9)
        return values

    return _with_values(text, change)


def shaken(text: str, random: np.random.Generator) -> str:
    """Noise on all channels."""
    return _with_values(text, lambda values: values + random.normal(0.0, 10.0 ** random.uniform(-1, 2.5), values.shape))


def thrown(text: str, random: np.random.Generator) -> str:
    """The body turns about any axis, for all of the clip or for a part of it."""

    def change(values: np.ndarray) -> np.ndarray:
        first = int(random.integers(len(values))) if random.random() < 0.5 else 0
        values[first:, 3:6] += random.uniform(-180.0, 180.0, 3)
        return values

    return _with_values(text, change)


def duplicated_joint(text: str, random: np.random.Generator) -> str:
    """A joint has another one's name."""
    names = re.findall(r"JOINT (\S+)", text)
    if len(names) < 2:
        return text
    one, other = random.choice(names, 2)
    return re.sub(rf"JOINT {re.escape(str(one))}\b", f"JOINT {other}", text, count=1)


def zero_bone(text: str, random: np.random.Generator) -> str:
    """A bone, or all of them, have no length."""
    offsets = list(re.finditer(r"OFFSET .*", text))
    if not offsets:
        return text
    if random.random() < 0.2:
        return re.sub(r"OFFSET .*", "OFFSET 0 0 0", text)
    one = offsets[int(random.integers(len(offsets)))]
    return text[: one.start()] + "OFFSET 0 0 0" + text[one.end() :]


def odd_bone(text: str, random: np.random.Generator) -> str:
    """A bone points elsewhere, or is much longer."""
    offsets = list(re.finditer(r"OFFSET .*", text))
    if not offsets:
        return text
    one = offsets[int(random.integers(len(offsets)))]
    values = random.normal(0.0, 10.0 ** random.uniform(0, 4), 3)
    return text[: one.start()] + "OFFSET " + " ".join(f"{v:.3f}" for v in values) + text[one.end() :]


def wrong_channels(text: str, random: np.random.Generator) -> str:
    """A joint has other channels than it says, or other ones."""
    lines = [k for k, line in enumerate(text.split("\n")) if "CHANNELS" in line]
    rows = text.split("\n")
    if lines:
        rows[lines[int(random.integers(len(lines)))]] = str(
            random.choice(["CHANNELS 0", "CHANNELS 2 Xrotation", "CHANNELS 1 Xscale", "CHANNELS 1 Xposition"])
        )
    return "\n".join(rows)


def lost_line(text: str, random: np.random.Generator) -> str:
    """A line is missing."""
    rows = text.split("\n")
    del rows[int(random.integers(len(rows)))]
    return "\n".join(rows)


def swapped_sides(text: str, random: np.random.Generator) -> str:
    """Left is named right."""
    return text.replace("Left", "Tmp").replace("Right", "Left").replace("Tmp", "Right")


MUTATIONS: tuple[Mutation, ...] = (
    cut_off,
    strange_word,
    strange_number,
    frame_time,
    frame_count,
    few_frames,
    frozen,
    zeroed,
    huge,
    shaken,
    thrown,
    duplicated_joint,
    zero_bone,
    odd_bone,
    wrong_channels,
    lost_line,
    swapped_sides,
)
