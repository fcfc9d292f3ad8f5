"""Tables of the study: means over its clips, and the worst where limits are concerned."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

MM = 1e3
CONFIDENCES = {
    "true": "no noise",
    "unsaid": "noise, all points alike",
    "gain": "noise, confidence as gain",
    "weight": "noise, confidence as weight",
}


def print_tables(figures: Mapping[str, Any], console: Console) -> None:
    """Print all of them."""
    gains = figures["gains"]
    names = list(next(iter(gains.values())))
    rows = [(f"high gain: {high}", *(_mean(gains, high, name) for name in names)) for high in names]
    _print(console, "Figure 5, rms mm", names, rows)
    priorities = figures["priorities"]
    first = next(iter(priorities.values()))
    levels = list(next(iter(first.values())))
    rows = [(name, *(_mean(priorities, name, level) for level in levels)) for name in first]
    _print(console, "Figure 6, rms mm", ["first: waist", "second: wrists", "third: others"], rows)
    rows = [
        (
            f"(14) {kind}",
            f"{np.degrees(max(of[kind]['beyond_rad'] for of in figures['limits'].values())):.1f}",
            f"{np.mean([of[kind]['joints_out'] for of in figures['limits'].values()]):.2f}",
            _mean(figures["limits"], kind, "points_rms_m"),
        )
        for kind in ("without", "with")
    ]
    _print(console, "Figure 7, joint limits", ["most beyond deg", "joints out a frame", "points rms mm"], rows)
    collisions = figures["collisions"]
    ways = [name for name in next(iter(collisions.values())) if not name.startswith("wrists")]
    rows = [
        (
            way,
            f"{MM * min(of[way] for of in collisions.values()):.0f}",
            f"{sum(of[way] >= 0.0 for of in collisions.values())} of {len(collisions)}",
            f"{MM * np.mean([of[f'wrists {way}'] for of in collisions.values()]):.0f}",
        )
        for way in ways
    ]
    _print(console, "Figures 11, 12, redirection", ["least distance mm", "clips clear", "wrists rms mm"], rows)
    confidence = figures["confidence"]
    rows = [
        (
            words,
            _mean(confidence, kind, "elbows"),
            _mean(confidence, kind, "wrists"),
            f"{np.mean([of[kind]['joint_speed_rms'] for of in confidence.values()]):.2f}",
        )
        for kind, words in CONFIDENCES.items()
    ]
    _print(console, "4.3.1, elbows seen badly", ["elbows rms mm", "wrists rms mm", "joint speed rms rad/s"], rows)
    rows = [
        (
            clip,
            f"{of['most']:.1f}",
            f"{of['late_s']:.2f}",
            "no" if of["fastest_play"] is None else f"yes, playing up to {of['fastest_play']:.2f} times as fast",
        )
        for clip, of in figures["velocities"].items()
    ]
    _print(console, "4.5, velocity limits", ["most over limit", "late s", "duration can be kept"], rows)
    narrowed = ", ".join(figures["virtual_limits"]) or "none"
    console.print(f"Virtual limits (4.6.1) narrower than the joints' ranges: {narrowed}", soft_wrap=True)


def _mean(figures: Mapping[str, Any], *keys: str) -> str:
    values = []
    for of in figures.values():
        for key in keys:
            of = of[key]
        values.append(of)
    return f"{MM * float(np.mean(values)):.1f}"


def _print(console: Console, title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column(title)
    for column in columns:
        table.add_column(column, justify="right")
    for row in rows:
        table.add_row(*row)
    console.print(table)
    console.print()
