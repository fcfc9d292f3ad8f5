"""Mermaid's flowcharts as pictures: drawn while the site is built, so that a page needs no script and no network.

Of Mermaid it knows what the pages use: `flowchart BT`, a node `name["<b>title</b><br/>text"]` and an edge
`from --> to` a line. Anything else is an error of the build.
"""

import re
from collections.abc import Sequence
from html import escape
from itertools import pairwise

BOX_HEIGHT, ROW_GAP, COLUMN_GAP, CHARACTER, PADDING = 52.0, 44.0, 18.0, 6.6, 14.0  # px
SWEEPS = 12
"""Passes that sort each row by where its neighbours are."""

Lines = tuple[str, ...]
Edge = tuple[str, str]


def parse(text: str) -> tuple[dict[str, Lines], list[Edge]]:
    """Nodes (name -> lines of text, the first one bold if it is in <b>) and edges of a flowchart.

    Raises:
        ValueError: If a line is neither.
    """
    head, *lines = [line.strip() for line in text.splitlines() if line.strip()]
    if head != "flowchart BT":
        raise ValueError(f"'{head}': only 'flowchart BT' is drawn")
    boxes: dict[str, Lines] = {}
    edges: list[Edge] = []
    for line in lines:
        if node := re.fullmatch(r'(\w+)\["(.+)"\]', line):
            boxes[node[1]] = tuple(re.split(r"<br\s*/?>", node[2]))
        elif edge := re.fullmatch(r"(\w+) --> (\w+)", line):
            edges.append((edge[1], edge[2]))
        else:
            raise ValueError(f"'{line}' is neither a node nor an edge")
    if unknown := {name for edge in edges for name in edge} - set(boxes):
        raise ValueError(f"no node is called {', '.join(sorted(unknown))}")
    return boxes, edges


def rows_of(boxes: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    """Row of each node, 0 on top: one more than the lowest of those that it points to.

    Raises:
        ValueError: If arrows run in a circle.
    """
    row = dict.fromkeys(boxes, 0)
    for _ in boxes:
        lower = {start: max(row[start], row[end] + 1) for start, end in edges if row[start] <= row[end]}
        if not lower:
            return row
        row.update(lower)
    raise ValueError("its arrows run in a circle")


class Layout:
    """Where boxes are: rows of them, sorted so that few arrows cross. A long arrow has a bend in each row it passes."""

    def __init__(self, boxes: dict[str, Lines], edges: Sequence[Edge]) -> None:
        row = rows_of(list(boxes), edges)
        self.width = {
            name: 2 * PADDING + CHARACTER * max(len(re.sub("<.*?>", "", line)) for line in lines)
            for name, lines in boxes.items()
        }
        self.rows: list[list[str]] = [[] for _ in range(max(row.values()) + 1)]
        for name in boxes:
            self.rows[row[name]].append(name)
        self.paths = []
        for start, end in edges:
            bends = [f"{start} {end} {k}" for k in range(row[start] - 1, row[end], -1)]
            for k, bend in zip(range(row[start] - 1, row[end], -1), bends, strict=True):
                self.width[bend] = 0.0
                self.rows[k].append(bend)
            self.paths.append([start, *bends, end])
        neighbours: dict[str, list[str]] = {name: [] for name in self.width}
        for path in self.paths:
            for one, other in pairwise(path):
                neighbours[one].append(other)
                neighbours[other].append(one)
        self.x: dict[str, float] = {}
        for names in self.rows:
            self._place(names)
        for sweep in range(SWEEPS):
            for names in self.rows if sweep % 2 else self.rows[::-1]:
                mean = {
                    name: sum(self.x[other] for other in neighbours[name]) / max(len(neighbours[name]), 1)
                    for name in names
                }
                names.sort(key=mean.__getitem__)
                self._place(names)
        self.left = min(self.x[name] - self.width[name] / 2 for name in self.x)
        self.right = max(self.x[name] + self.width[name] / 2 for name in self.x)

    def _place(self, names: Sequence[str]) -> None:
        """Centres of one row's boxes, side by side about the middle."""
        x = -(sum(self.width[name] for name in names) + COLUMN_GAP * (len(names) - 1)) / 2
        for name in names:
            self.x[name] = x + self.width[name] / 2
            x += self.width[name] + COLUMN_GAP


def drawing(text: str) -> str:
    """The flowchart as SVG, in the page's own colours."""
    boxes, edges = parse(text)
    layout = Layout(boxes, edges)
    top = {name: k * (BOX_HEIGHT + ROW_GAP) for k, names in enumerate(layout.rows) for name in names}
    parts = []
    for path in layout.paths:
        x, y = layout.x[path[0]], top[path[0]]
        line = f"M{x:.0f},{y:.0f}"
        for name in path[1:]:
            below, middle = top[name] + BOX_HEIGHT, (y + top[name] + BOX_HEIGHT) / 2
            end = below + (6.0 if name == path[-1] else 0.0)
            line += f" C{x:.0f},{middle:.0f} {layout.x[name]:.0f},{middle:.0f} {layout.x[name]:.0f},{end:.0f}"
            x, y = layout.x[name], top[name]
            if name != path[-1]:
                line += f" L{x:.0f},{y:.0f}"
        parts.append(f'<path class="arrow" d="{line}" marker-end="url(#flowchart-arrow)"/>')
    for name, lines in boxes.items():
        x, y, width = layout.x[name], top[name], layout.width[name]
        parts.append(
            f'<rect x="{x - width / 2:.0f}" y="{y:.0f}" width="{width:.0f}" height="{BOX_HEIGHT:.0f}" rx="6"/>'
        )
        for k, words in enumerate(lines):
            baseline = y + BOX_HEIGHT / 2 + 5.0 + 18.0 * (k - (len(lines) - 1) / 2)
            weight = ' class="title"' if "<b>" in words else ""
            parts.append(f'<text x="{x:.0f}" y="{baseline:.0f}"{weight}>{escape(re.sub("<.*?>", "", words))}</text>')
    view = f"{layout.left - 2:.0f} -2 {layout.right - layout.left + 4:.0f} {max(top.values()) + BOX_HEIGHT + 4:.0f}"
    said = "; ".join(f"{start} to {end}" for start, end in edges)
    return (
        f'<div class="flowchart"><svg viewBox="{view}" width="{layout.right - layout.left + 4:.0f}" role="img" '
        f'aria-label="Arrows: {escape(said)}"><defs><marker id="flowchart-arrow" viewBox="0 0 8 8" refX="6" refY="4" '
        f'markerWidth="7" markerHeight="7" orient="auto"><path d="M0,0 L8,4 L0,8 z"/></marker></defs>'
        f"{''.join(parts)}</svg></div>"
    )
