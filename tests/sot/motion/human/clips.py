"""Small clips made of the shipped one: each as the text of a .bvh file."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

GROOVE = Path(__file__).parents[4] / "scenarios/inputs/data/groove.bvh"
RATE = 50.0
Change = Callable[[dict[str, np.ndarray]], None]


def short_groove(frames: int = 4, first: int = 0) -> str:
    """Some frames of the shipped clip."""
    head, _, motion = GROOVE.read_text().partition("MOTION\n")
    rows = motion.splitlines()[2 + first : 2 + first + frames]
    return "\n".join([head + "MOTION", f"Frames: {len(rows)}", "Frame Time: 0.02", *rows, ""])


def changed_groove(change: Change, frames: int = 100, first: int = 100) -> str:
    """Some frames of the shipped clip, changed in place.

    change: is given each joint's angles about Y, X, Z (T, 3) [deg] by its name, and the hips' places (T, 3), X left,
        Y up, Z forward, as "place" [cm].
    """
    head, _, motion = short_groove(frames, first).partition("MOTION\n")
    values = np.array([line.split() for line in motion.splitlines()[2:]], dtype=float)
    names = re.findall(r"(?:ROOT|JOINT) (\S+)", head)
    columns = {"place": values[:, :3]} | {name: values[:, 3 * k + 3 : 3 * k + 6] for k, name in enumerate(names)}
    change(columns)
    rows = [" ".join(f"{value:.4f}" for value in row) for row in values]
    return "\n".join([head + "MOTION", f"Frames: {len(rows)}", "Frame Time: 0.02", *rows, ""])


def seated(joints: dict[str, np.ndarray]) -> None:
    """On a chair, while the upper body dances."""
    joints["place"][:] = 0.0, 51.0, 0.0
    joints["Hips"][:] = 0.0
    for side in ("Left", "Right"):
        joints[f"{side}UpLeg"][:] = 0.0, -90.0, 0.0
        joints[f"{side}Leg"][:] = 0.0, 90.0, 0.0
        joints[f"{side}Foot"][:] = 0.0


def lying(joints: dict[str, np.ndarray]) -> None:
    """On the back, while the arms dance."""
    joints["place"][:] = 0.0, 12.0, 0.0
    joints["Hips"][:] = 0.0, -90.0, 0.0
    for side in ("Left", "Right"):
        for joint in ("UpLeg", "Leg", "Foot"):
            joints[side + joint][:] = 0.0


def on_one_leg(joints: dict[str, np.ndarray]) -> None:
    """The right foot is held up throughout."""
    joints["RightUpLeg"][:, 1] -= 50.0
    joints["RightLeg"][:, 1] += 60.0


def jumping(joints: dict[str, np.ndarray]) -> None:
    """One frame is three metres aside."""
    joints["place"][50, 0] += 300.0


def drifting(joints: dict[str, np.ndarray]) -> None:
    """The floor rises by 20 cm in 2 s."""
    joints["place"][:, 1] += 10.0 * np.arange(len(joints["place"])) / RATE


def x_up(text: str) -> str:
    """The same clip with its axes renamed: what was up, Y, is X, and so on."""
    renamed = {"X": "Z", "Y": "X", "Z": "Y"}
    text = re.sub(r"([XYZ])(position|rotation)", lambda found: renamed[found[1]] + found[2], text)
    return re.sub(r"OFFSET (\S+) (\S+) (\S+)", r"OFFSET \2 \3 \1", text)
