"""The HRP-2-like robot's own files with changes, as other people's models differ from it."""

from collections.abc import Sequence
from pathlib import Path

from sot.robots.models import hrp2
from sot.robots.robot import Robot

Change = tuple[str, str]


def write_variant(folder: Path, model: Sequence[Change] = (), file: Sequence[Change] = ()) -> Path:
    """Write model and robot file, in each of which some text is replaced once; returns the robot file."""
    texts = hrp2.file_texts()
    for name, changes in (("hrp2.xml", model), ("hrp2.toml", file)):
        text = texts[name]
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "hrp2.toml"


def load_variant(folder: Path, model: Sequence[Change] = (), file: Sequence[Change] = ()) -> Robot:
    """The robot of such files."""
    return Robot.load(write_variant(folder, model, file))
