"""The plots of a run's page, or of a page that compares several: one colour a run, dashes for what was planned.

They are figures in plotly's terms, data and layout, as plain dictionaries: its Python objects take a minute for a page.
"""

from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sim.reporting.traces import Traces

RUN_COLORS = ("#e07b2a", "#3b86d1", "#3f9e5f", "#a066c9", "#c9527f", "#8a8f3c", "#4aa5a8", "#b0703f")
"""Colours of the runs, in turn; each readable on white and on black."""
LIMIT_COLOR = "#d04545"
PLANNED_OPACITY = 0.55  # opacity of planned curves
LINE_WIDTH_PX = 1.3
PLOT_HEIGHT_PX, TALL_PLOT_HEIGHT_PX, LANE_HEIGHT_PX = 250, 340, 26  # pixels
RANGE_MARGIN = 0.06  # margin beyond limits, over the range between them
MM_PER_M = 1e3


@dataclass(frozen=True)
class ShownRun:
    """A run on a page.

    Attributes:
        name: that sets it apart from the others.
        color: of its curves.
        traces: what is shown.
    """

    name: str
    color: str
    traces: Traces

    def __getitem__(self, column: str) -> np.ndarray:
        return self.traces.columns[column]

    @property
    def facts(self) -> Mapping[str, Any]:
        """The traces' facts."""
        return self.traces.facts

    def column_of(self, column: str, names: str, name: str) -> np.ndarray | None:
        """The part of a column (T, n) that belongs to one of `facts[names]`; None if this run has no such thing."""
        known = self.facts[names]
        return self[column][:, known.index(name)] if name in known else None


@dataclass
class Plot:
    """A plot with its title.

    Attributes:
        title: with the unit.
        height: in pixels.
        over_time: whether its horizontal axis is time, which all such plots of a page share.
        data, layout: plotly's.
    """

    title: str
    height: int = PLOT_HEIGHT_PX
    over_time: bool = True
    data: list[dict[str, Any]] = field(default_factory=list)
    layout: dict[str, Any] = field(default_factory=lambda: {"xaxis": {}, "yaxis": {}, "shapes": []})

    @property
    def figure(self) -> dict[str, Any]:
        """What plotly takes."""
        return {"data": self.data, "layout": self.layout}

    def add_over_time(
        self, run: ShownRun, values: np.ndarray, name: str = "", dash: str = "solid", **style: Any
    ) -> None:
        """Draw a column over time."""
        self.add_line(run, run["time"], values, name, dash, **style)

    def add_line(
        self,
        run: ShownRun,
        x: np.ndarray,
        y: np.ndarray,
        name: str = "",
        dash: str = "solid",
        width: float = LINE_WIDTH_PX,
        **style: Any,
    ) -> None:
        """Draw a line in a run's colour."""
        self.data.append(
            {
                "type": "scatter",
                "mode": "lines",
                "x": _plotly_array(x),
                "y": _plotly_array(y),
                "name": f"{run.name}: {name}" if name else run.name,
                "line": {"color": run.color, "width": width, "dash": dash},
                "legendgroup": run.name,
                **style,
            }
        )

    def add_level_line(self, value: float, axis: str = "y") -> None:
        """Draw a level line."""
        ends = {"xref": "paper", "x0": 0, "x1": 1, "yref": axis, "y0": value, "y1": value}
        self.layout["shapes"].append({"type": "line", **ends, "line": {"color": LIMIT_COLOR, "width": 1}})

    def add_limits(self, values: Sequence[float], axis: str = "y") -> None:
        """Draw level lines; what is shown reaches from the lowest to the highest."""
        for value in values:
            self.add_level_line(value, axis)
        drawn = [shape["y0"] for shape in self.layout["shapes"] if shape["yref"] == axis]
        room = RANGE_MARGIN * (max(drawn) - min(drawn))
        self.layout[axis.replace("y", "yaxis")]["range"] = [min(drawn) - room, max(drawn) + room]


def balance_plots(runs: Sequence[ShownRun]) -> list[Plot]:
    """Zero-moment point over time and from above, centre of mass."""
    zmp = _stacked_plot("ZMP in the planned support [mm]", "x", "y", TALL_PLOT_HEIGHT_PX)
    for axis, side in enumerate(("y", "y2")):
        for run in runs:
            edge: dict[str, Any] = {"width": 0.5, "hoverinfo": "skip", "yaxis": side}
            zmp.add_over_time(run, MM_PER_M * run["support_least"][:, axis], "support", **edge)
            zmp.add_over_time(
                run,
                MM_PER_M * run["support_greatest"][:, axis],
                "support",
                fill="tonexty",
                fillcolor=_pale_color(run),
                **edge,
            )
        for run in runs:
            for column, name, dash in (("zmp_control", "controller", "dot"), ("zmp_planned", "planned", "dash")):
                zmp.add_over_time(run, MM_PER_M * run[column][:, axis], name, dash, opacity=PLANNED_OPACITY, yaxis=side)
            zmp.add_over_time(run, MM_PER_M * run["zmp_measured"][:, axis], "measured", yaxis=side)
    error = _overlaid_plot(
        "Centre of mass off its reference [mm]", runs, lambda run: MM_PER_M * run["com_error"], TALL_PLOT_HEIGHT_PX
    )
    return [zmp, _zmp_from_above(runs), error]


def force_plots(runs: Sequence[ShownRun]) -> list[Plot]:
    """Plots of the floor's force on each foot."""
    plots = []
    for foot in _names_of_all_runs(runs, "feet"):
        plot = _stacked_plot(f"{_title_words(foot)} [N]", "upwards", "along the floor")
        for run in runs:
            for column, side in (("force_normal", "y"), ("force_along", "y2")):
                values = run.column_of(column, "feet", foot)
                if values is not None:
                    plot.add_over_time(run, values, yaxis=side)
        plots.append(plot)
    return plots


def schedule_plots(runs: Sequence[ShownRun]) -> list[Plot]:
    """Tasks and contacts of each run, a lane each."""
    return [_lanes_plot(run) for run in runs]


def limb_plots(runs: Sequence[ShownRun]) -> dict[str, list[Plot]]:
    """Angle and torque of every joint, by limb."""
    joints: dict[str, dict[str, None]] = {}
    for run in runs:
        for limb, members in run.facts["limbs"].items():
            joints.setdefault(_title_words(limb), {}).update(dict.fromkeys(run.facts["joints"][k] for k in members))
    return {limb: [_joint_plot(runs, name) for name in names] for limb, names in joints.items()}


def task_plots(runs: Sequence[ShownRun]) -> list[Plot]:
    """Error of every task."""
    units = {name: unit for run in runs for name, unit in zip(run.facts["tasks"], run.facts["task_units"], strict=True)}

    def errors(name: str) -> Callable[[ShownRun], np.ndarray | None]:
        return lambda run: run.column_of("task_error", "tasks", name)

    return [_overlaid_plot(f"{name} [{unit}]", runs, errors(name)) for name, unit in units.items()]


def tick_time_plots(runs: Sequence[ShownRun]) -> list[Plot]:
    """Time of the control ticks and of their parts."""
    plots = []
    for k, title in enumerate(("Tick", "Robot model", "Rows of the stack", "Solver")):
        plot = Plot(f"{title} [µs]")
        for run in runs:
            plot.add_line(
                run, run["tick_time"], run["tick_greatest"][:, k], "greatest", "dot", width=0.8, opacity=PLANNED_OPACITY
            )
            plot.add_line(run, run["tick_time"], run["tick_median"][:, k], "median")
        plot.layout["yaxis"] = {"type": "log", "dtick": 1}
        plots.append(plot)
    for period in {run.facts["period_s"] for run in runs}:
        plots[0].add_level_line(1e6 * period)
    return plots


def _zmp_from_above(runs: Sequence[ShownRun]) -> Plot:
    plot = Plot(
        "The same from above, with the planned soles; x forwards, y to the left [mm]",
        TALL_PLOT_HEIGHT_PX,
        over_time=False,
    )
    for run in runs:
        gap = np.full((1, 2), np.nan)
        soles = np.concatenate([part for sole in run.facts["footholds"] for part in (MM_PER_M * np.array(sole), gap)])
        way = MM_PER_M * run["zmp_way"]
        plot.add_line(run, soles[:, 0], soles[:, 1], "soles", width=1.0, opacity=PLANNED_OPACITY)
        plot.add_line(run, way[:, 0], way[:, 1], "measured", width=0.9)
    plot.layout["yaxis"] = {"scaleanchor": "x"}
    plot.layout["hovermode"] = "closest"
    return plot


def _joint_plot(runs: Sequence[ShownRun], name: str) -> Plot:
    plot = _stacked_plot(name, "deg", "N m")
    for run in runs:
        angle, reference, torque = (
            run.column_of(column, "joints", name) for column in ("angle", "reference", "torque")
        )
        if angle is None or reference is None or torque is None:
            continue
        joint = run.facts["joints"].index(name)
        plot.add_over_time(run, np.rad2deg(reference), "reference", "dash", opacity=PLANNED_OPACITY)
        plot.add_over_time(run, np.rad2deg(angle), "angle")
        plot.add_over_time(run, torque, "torque", yaxis="y2")
        plot.add_limits([float(np.rad2deg(run.facts[side][joint])) for side in ("lower", "upper")])
        plot.add_limits([-run.facts["effort"][joint], run.facts["effort"][joint]], "y2")
    return plot


def _lanes_plot(run: ShownRun) -> Plot:
    lanes = run.facts["lanes"]
    plot = Plot(run.name, LANE_HEIGHT_PX * len(lanes) + 60)
    bars = [(lane["name"], *bar) for lane in lanes for bar in lane["bars"]]
    names, starts, ends, colors, labels, opacities = zip(*bars, strict=True) if bars else ((),) * 6
    plot.data.append(
        {
            "type": "bar",
            "orientation": "h",
            "y": names,
            "base": starts,
            "x": np.subtract(ends, starts).tolist(),
            "marker": {"color": colors, "opacity": opacities},
            "text": labels,
            "textposition": "inside",
            "insidetextanchor": "middle",
            "textangle": 0,
            "textfont": {"color": "#1b1e22", "size": 10},
            "hovertemplate": "%{y} %{text}: from %{base:.2f} s, for %{x:.2f} s<extra></extra>",
            "legendgroup": run.name,
        }
    )
    plot.layout["yaxis"] = {"autorange": "reversed", "automargin": True, "fixedrange": True}
    plot.layout |= {"barmode": "overlay", "bargap": 0.25, "hovermode": "closest"}
    return plot


def _stacked_plot(title: str, above: str, below: str, height: int = PLOT_HEIGHT_PX) -> Plot:
    """A plot with two vertical axes, one above the other, each with its label."""
    plot = Plot(title, height)
    plot.layout["xaxis"] = {"anchor": "y2"}
    plot.layout["yaxis"] = {"domain": [0.53, 1.0], "title": {"text": above}}
    plot.layout["yaxis2"] = {"domain": [0.0, 0.47], "title": {"text": below}}
    return plot


def _overlaid_plot(
    title: str, runs: Sequence[ShownRun], values: Callable[[ShownRun], np.ndarray | None], height: int = PLOT_HEIGHT_PX
) -> Plot:
    plot = Plot(title, height)
    for run in runs:
        column = values(run)
        if column is not None:
            plot.add_over_time(run, column)
    return plot


def _names_of_all_runs(runs: Sequence[ShownRun], names: str) -> list[str]:
    return list(dict.fromkeys(name for run in runs for name in run.facts[names]))


def _title_words(name: str) -> str:
    return name.replace("_", " ").capitalize()


def _pale_color(run: ShownRun) -> str:
    red, green, blue = (int(run.color[k : k + 2], 16) for k in (1, 3, 5))
    return f"rgba({red},{green},{blue},0.10)"


def _plotly_array(values: np.ndarray) -> dict[str, str]:
    """Numbers as base64 of single precision, which plotly reads fastest and which is smallest."""
    return {"dtype": "f4", "bdata": b64encode(values.astype("<f4").tobytes()).decode()}
