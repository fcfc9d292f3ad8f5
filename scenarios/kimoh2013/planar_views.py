"""Pictures of the planar arm's runs: Kim & Oh's Figures 4-8 as one picture, and a recording."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from scenarios.kimoh2013 import planar_arm as arm
from scenarios.kimoh2013.planar_arm import ArmRun
from sim.recording.columns import TIMELINE, Columns, css_color
from sim.recording.recorder import open_recording
from sim.reporting.chart import Curve, Panel, limit_lines, write_panels

Array = np.ndarray

METHOD_COLORS = {"cascade": (43, 111, 217), "iktc": (217, 118, 43), "clamped": (120, 160, 60)}
DRAWN_POSES = 11
ARM_SPACING = 3.2  # m, between two arms of the recording
ERROR_UNITS = ("mm", "mm", "deg")
ERROR_FACTORS = np.array([1e3, 1e3, 180.0 / np.pi])


def draw_picture(path: Path, tracks: Mapping[str, ArmRun], rate: float) -> None:
    """Figures 4–8: poses of each method, joints over time with their limits, and the tasks' errors."""
    panels = [
        Panel(f"{name}: tip on its way", "m", "m", _pose_curves(track), equal=True) for name, track in tracks.items()
    ]
    end, degree = arm.DURATION, arm.DEGREE
    kinds = (
        ("angle [deg]", "q", [arm.LOWER, arm.UPPER]),
        ("speed [deg/s]", "v", [-arm.VELOCITY, arm.VELOCITY]),
        ("acceleration [deg/s²]", "a", [-arm.ACCELERATION, arm.ACCELERATION]),
    )
    for joint in range(3):
        for words, column, ends in kinds:
            curves = [
                Curve(track.time, getattr(track, column)[:, joint] / degree, css_color(METHOD_COLORS[name]), name)
                for name, track in tracks.items()
            ]
            curves += limit_lines([e[joint] / degree for e in ends], end)
            panels.append(Panel(f"joint {joint + 1}", "s", words, curves))
    for k, task in enumerate(arm.TASK_NAMES):
        curves = []
        for name, track in tracks.items():
            with np.errstate(divide="ignore"):
                size = np.log10(np.abs(ERROR_FACTORS[k] * track.error[:, k]))
            curves.append(Curve(track.time, size, css_color(METHOD_COLORS[name]), name))
        panels.append(Panel(f"error of {task}", "s", f"log10 |error / {ERROR_UNITS[k]}|", curves))
    write_panels(path, f"Three tasks of a planar arm under joint limits (Kim & Oh 3.3), {rate:g} Hz", panels, 3)


def write_recording(path: Path, tracks: Mapping[str, ArmRun], rate: float) -> None:
    """The arms beside each other with their tips' paths, and curves of joints and errors."""
    with open_recording(path, f"planar3r, {rate:g} Hz", ABOUT_TEXT, _layout()) as columns:
        for index, (name, track) in enumerate(tracks.items()):
            _record_arm(columns, name, track, np.array([ARM_SPACING * index, 0.0]))


ABOUT_TEXT = """# Three tasks of a planar arm under joint limits

Kim & Oh, 3.3: each arm under its method's name. Red: where the tip is wanted, and its way.
"""


def _record_arm(columns: Columns, name: str, track: "ArmRun", aside: Array) -> None:
    """One arm, drawn somewhere."""
    shapes = np.zeros((len(track.time), 4, 3), dtype=np.float32)
    shapes[..., :2] = arm.link_ends(track.q) + aside
    shapes[..., 1] *= -1.0  # the view's axis points down
    wanted = np.array([arm.desired_tasks(t)[0] for t in track.time])
    way = np.column_stack([wanted[:, 1], -wanted[:, 0]]) + aside
    entity = f"arms/{name}"
    columns.static(f"{entity}/way", rr.LineStrips2D([way], colors=[(200, 60, 60)]))
    label = rr.Points2D([aside + np.array([0.0, 0.3])], labels=[name], radii=[0.01], colors=[METHOD_COLORS[name]])
    columns.static(f"{entity}/name", label)
    columns.static(f"{entity}/links", rr.LineStrips2D.from_fields(colors=[METHOD_COLORS[name]], radii=[0.025]))
    columns.over_time(f"{entity}/links", track.time, rr.LineStrips2D.columns(strips=list(shapes[..., :2])))
    columns.static(f"{entity}/goal", rr.Points2D.from_fields(colors=[(200, 60, 60)], radii=[0.05]))
    columns.over_time(f"{entity}/goal", track.time, rr.Points2D.columns(positions=way.astype(np.float32)))
    for kind in ("q", "v", "a"):
        for joint in range(3):
            _curve(columns, f"{kind}/{joint + 1}/{name}", track.time, getattr(track, kind)[:, joint] / arm.DEGREE, name)
    for k, task in enumerate(arm.TASK_NAMES):
        _curve(columns, f"error/{task}/{name}", track.time, ERROR_FACTORS[k] * track.error[:, k], name)
    _curve(columns, f"qps/{name}", track.time, track.qps.astype(float), name)


def _curve(columns: Columns, entity: str, times: Array, values: Array, name: str) -> None:
    columns.static(entity, rr.SeriesLines(colors=[METHOD_COLORS[name]], names=[name]))
    columns.over_time(entity, times, rr.Scalars.columns(scalars=values))


def _layout() -> rrb.Blueprint:
    def plot(origin: str, name: str) -> rrb.TimeSeriesView:
        return rrb.TimeSeriesView(origin=origin, name=name)

    kinds = (("q", "position [deg]"), ("v", "speed [deg/s]"), ("a", "acceleration [deg/s²]"))
    joints = [
        rrb.Vertical(*(plot(f"{kind}/{joint}", f"q_{joint}, {words}") for joint in (1, 2, 3)), name=words)
        for kind, words in kinds
    ]
    errors = [plot(f"error/{task}", f"{task} [{unit}]") for task, unit in zip(arm.TASK_NAMES, ERROR_UNITS, strict=True)]
    tasks = rrb.Vertical(*errors, plot("qps", "quadratic programs"), name="errors")
    scene = rrb.Spatial2DView(origin="arms", name="Arms")
    return rrb.Blueprint(
        rrb.Horizontal(
            scene, rrb.Tabs(tasks, *joints, rrb.TextDocumentView(origin="about", name="About")), column_shares=[3, 2]
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, loop_mode="all"),
    )


def _pose_curves(track: "ArmRun") -> list[Curve]:
    shown = np.linspace(0, len(track.time) - 1, DRAWN_POSES).round().astype(int)
    shapes = arm.link_ends(track.q[shown])
    curves = [Curve(shape[:, 0], shape[:, 1], "#9ab", width=1.2) for shape in shapes]
    wanted = np.array([arm.desired_tasks(t)[0] for t in track.time])
    tip = arm.link_ends(track.q)[:, -1]
    curves.append(Curve(wanted[:, 1], wanted[:, 0], "#c33", "wanted", dashed=True, width=2.0))
    return [*curves, Curve(tip[:, 0], tip[:, 1], "#333", "reached")]
