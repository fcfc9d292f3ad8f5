"""Small clips made of the shipped one."""

from pathlib import Path

GROOVE = Path(__file__).parents[4] / "scenarios/inputs/data/groove.bvh"


def short_groove(frames: int = 4, first: int = 0) -> str:
    """Some frames of the shipped clip, as the text of a .bvh file."""
    head, _, motion = GROOVE.read_text().partition("MOTION\n")
    rows = motion.splitlines()[2 + first : 2 + first + frames]
    return "\n".join([head + "MOTION", f"Frames: {len(rows)}", "Frame Time: 0.02", *rows, ""])
