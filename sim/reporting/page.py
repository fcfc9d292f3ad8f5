"""A run, or several to compare, as one page (HTML) that any browser shows, without a network."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from sim.reporting import page_plots, report
from sim.reporting.page_plots import RUN_COLORS, Plot, ShownRun
from sim.reporting.traces import Traces
from sot.whole_file import atomic_write

TEMPLATE = "page.html"


@dataclass(frozen=True)
class Section:
    """Plots under a heading, in groups; a group with a name can be folded.

    Attributes:
        title, caption: what is shown, and how to read it.
        groups: name (empty: always open) -> plots.
        wide: whether each plot takes the whole width.
    """

    title: str
    caption: str
    groups: Mapping[str, Sequence[Plot]]
    wide: bool = False

    @property
    def anchor(self) -> str:
        """To link to."""
        return self.title.lower().replace(" ", "-")


def write_html(
    path: Path, names: Sequence[str], reports: Sequence[Mapping[str, Any]], traces: Sequence[Traces]
) -> None:
    """Write a page, which appears under its name once it is complete.

    Args:
        path: file to write (`.html`).
        names: of the runs, no two alike.
        reports: their figures.
        traces: their columns.

    Raises:
        KeyError: a report lacks a figure.
    """
    runs = [
        ShownRun(name, RUN_COLORS[k % len(RUN_COLORS)], columns)
        for k, (name, columns) in enumerate(zip(names, traces, strict=True))
    ]
    environment = Environment(loader=PackageLoader("sim", "."), autoescape=True, undefined=StrictUndefined)
    environment.filters["figure"] = _json_for_page
    page = environment.get_template(TEMPLATE).render(
        title=" and ".join(names) if len(names) < 4 else f"{len(names)} runs",
        runs=runs,
        reports=reports,
        summary=list(report.table_rows(reports)),
        remarks=[
            (name, said) for name, one in zip(names, reports, strict=True) for said in (*one["remarks"], *one["edits"])
        ],
        sections=_sections(runs),
        library=Markup(get_plotlyjs()),
    )
    with atomic_write(path) as place:
        place.write_text(page, encoding="utf-8")


def _sections(runs: Sequence[ShownRun]) -> list[Section]:
    return [
        Section(
            "Balance",
            "The zero-moment point (ZMP) is where the floor's force acts. It has to stay within the soles that carry, "
            "the support (shaded): at its edge the robot begins to tip. Solid: measured; dashed: planned; dotted: "
            "predicted by the controller.",
            {"": page_plots.balance_plots(runs)},
        ),
        Section(
            "Contact forces",
            "The floor's force on each foot, measured. Along the floor only friction holds.",
            {"": page_plots.force_plots(runs)},
        ),
        Section(
            "Schedule",
            "Which tasks are in the stack, and what the feet are planned to do. The number is the level that a task is "
            "in: 1 comes first. Pale: on its way from one level to another.",
            {"": page_plots.schedule_plots(runs)},
            wide=True,
        ),
        Section(
            "Joints",
            "Above: angle, solid, and its reference, dashed. Below: torque, as commanded. Red: limits.",
            page_plots.limb_plots(runs),
        ),
        Section(
            "Task errors",
            "How far each task is from what it asks for.",
            {"": page_plots.task_plots(runs)},
        ),
        Section(
            "Tick times",
            "How long the controller thinks each tick, and on what. Solid: median of a stretch of ticks; dotted: "
            "greatest; red: the control period.",
            {"": page_plots.tick_time_plots(runs)},
        ),
    ]


def _json_for_page(figure: Mapping[str, Any]) -> Markup:
    """A figure as JSON that may stand in a page: without anything that could end the script around it."""
    return Markup(json.dumps(figure, separators=(",", ":")).replace("<", "\\u003c"))
