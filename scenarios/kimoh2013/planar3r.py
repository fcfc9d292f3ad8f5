"""A planar arm of three joints follows three tasks against its joint limits, Kim & Oh 3.3: cascade, IKTC, clamping."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.kimoh2013 import planar_arm as arm
from scenarios.kimoh2013 import planar_views
from scenarios.kimoh2013.planar_arm import ArmRun
from scenarios.kimoh2013.printed_bounds import PrintedBounds
from scenarios.kimoh2013.rivals import ClampedCascade, LevelByLevel
from scenarios.replay import RECORDING_FILE, ProgressCallback
from solvers import Cascade, Level, Rows, Solution, Solver, TaskCorrection
from tasks.bounds import AccelerationBounds

Array = np.ndarray
Bounds = Callable[[Array, Array, float], tuple[Array, Array]]

PICTURE_FILE = "planar3r.svg"
BRAKING_SHARE = 0.5
"""Share of the acceleration limit relied upon to stop before the end of a range. With all of it, as in Kim (14), the
other joints have nothing left: while q_1 brakes, the tip's height takes 1.46 times its acceleration of q_2."""


def viable_bounds(brake: float) -> Bounds:
    """Kim (14) in a viable form, which can always be kept; braking relies on a share of the acceleration limit."""
    return AccelerationBounds(arm.LOWER, arm.UPPER, arm.VELOCITY, brake * arm.ACCELERATION, arm.ACCELERATION)


def printed_bounds_with_fallback() -> Bounds:
    """Kim (14) to the letter. Where it is empty, the bound of the speed gives way; outside the range it is that of its
    end."""
    printed = PrintedBounds(arm.LOWER, arm.UPPER, arm.VELOCITY, arm.ACCELERATION)

    def bounds(q: Array, v: Array, period: float) -> tuple[Array, Array]:
        lower, upper = printed(np.clip(q, arm.LOWER, arm.UPPER), v, period)
        binding = np.where(np.abs(lower) > np.abs(upper), lower, upper)
        return np.where(lower > upper, binding, lower), np.where(lower > upper, binding, upper)

    return bounds


METHODS: dict[str, tuple[Callable[[], Solver], Callable[[], Bounds]]] = {
    "cascade": (Cascade, partial(viable_bounds, BRAKING_SHARE)),
    "a QP a level": (LevelByLevel, partial(viable_bounds, BRAKING_SHARE)),
    "iktc": (TaskCorrection, partial(viable_bounds, BRAKING_SHARE)),
    "clamped": (ClampedCascade, partial(viable_bounds, BRAKING_SHARE)),
    "iktc, full brake": (TaskCorrection, partial(viable_bounds, 1.0)),
    "iktc, as printed": (TaskCorrection, printed_bounds_with_fallback),
}
"""The general framework twice, by this project's cascade and by one quadratic program a level as in the paper; the
paper's method; the solution without limits, clamped to them; and the paper's method with its own bounds, in the form
that can be kept and to the letter."""
TABLE_COLUMNS: Sequence[tuple[str, float, str]] = (
    ("error.P_y", 1e3, "P_y\nmm"),
    ("error.P_x", 1e3, "P_x\nmm"),
    ("error.θ_3", 1.0 / arm.DEGREE, "θ_3\ndeg"),
    ("beyond.position", 1.0 / arm.DEGREE, "range\ndeg"),
    ("beyond.velocity", 100.0, "speed\n%"),
    ("beyond.acceleration", 100.0, "acc.\n%"),
    ("qps.mean", 1.0, "QPs\nmean"),
    ("qps.most", 1.0, "\nmost"),
    ("solve_us.free", 1.0, "free\nµs"),
    ("solve_us.bound", 1.0, "bound\nµs"),
)
"""Place in a method's figures, factor to the unit read, words: most off, most beyond limits, quadratic programs a tick,
and the solver's median time while all tasks are kept and while one is not."""
DRAWN_METHODS = ("cascade", "iktc", "clamped")


def follow_tasks(solver: Solver, bounds: Bounds, period: float) -> ArmRun:
    """Let the arm follow the tasks for `planar_arm.DURATION`; accelerations are constant over a period [s]."""
    ticks = round(arm.DURATION / period)
    q, v = arm.START_ANGLES, np.zeros(3)
    columns: dict[str, list[Any]] = {name: [] for name in ("time", "q", "v", "a", "error", "qps", "solve_us")}
    furthest = 0.0
    for k in range(ticks + 1):
        t = k * period
        levels = hierarchy(t, q, v, bounds(q, v, period))
        begun = perf_counter()
        solution = solver.solve(levels)
        took = 1e6 * (perf_counter() - begun)
        a = solution.x
        error = arm.desired_tasks(t)[0] - arm.task_state(q, v).value
        for name, value in zip(columns, (t, q, v, a, error, _qp_count(solution), took), strict=True):
            columns[name].append(value)
        turn = np.clip(np.divide(-v, a, out=np.zeros(3), where=a != 0.0), 0.0, period)
        for way in (turn, period):
            at = q + v * way + 0.5 * a * way**2
            furthest = max(furthest, float(np.maximum(at - arm.UPPER, arm.LOWER - at).max()))
        q, v = q + v * period + 0.5 * a * period**2, v + a * period
    return ArmRun(**{name: np.array(values) for name, values in columns.items()}, max_beyond_range=furthest)


def hierarchy(t: float, q: Array, v: Array, bounds: tuple[Array, Array]) -> list[Level]:
    """The bounds, and the three tasks below them."""
    J, h = arm.task_rows(t, q, v)
    levels = [Level.stack("bounds", [Rows("bounds", "rad/s²", np.eye(3), *bounds)], 3)]
    for k, name in enumerate(arm.TASK_NAMES):
        levels.append(Level.stack(name, [Rows(name, "SI", J[k : k + 1], h[k : k + 1], h[k : k + 1])], 3))
    return levels


def study(rate: float, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Run all methods; write the picture of Figures 4–8 and the recording to the folder `out`.

    Args:
        rate: Of the control [Hz].
        out: Folder for both.
        tell: Told of the progress.

    Returns:
        The figures.
    """
    tracks = {}
    for k, (name, (solver, bounds)) in enumerate(METHODS.items()):
        tell(name, k / len(METHODS))
        tracks[name] = follow_tasks(solver(), bounds(), 1.0 / rate)
    shown = {name: tracks[name] for name in DRAWN_METHODS}
    planar_views.draw_picture(out / PICTURE_FILE, shown, rate)
    planar_views.write_recording(out / RECORDING_FILE, shown, rate)
    return {
        "scenario": "planar3r",
        "rate_hz": rate,
        "methods": {name: _figures(track) for name, track in tracks.items()},
        "iktc_off_cascade_rad": float(np.abs(tracks["iktc"].q - tracks["cascade"].q).max()),
    }


def show(figures: dict[str, Any], console: Console) -> None:
    """Print the figures as a table."""
    table = Table(box=None, padding=(0, 1, 0, 0))
    table.add_column("", no_wrap=True)
    for _, _, words in TABLE_COLUMNS:
        table.add_column(words, justify="right", no_wrap=True)
    for name, method in figures["methods"].items():
        values = ((factor * method[place.split(".")[0]][place.split(".")[1]]) for place, factor, _ in TABLE_COLUMNS)
        table.add_row(name, *(f"{value:.0f}" if value >= 100.0 else f"{round(value, 6):.2g}" for value in values))
    console.print(table)
    console.print("Tasks: most off. Limits: most beyond. QPs a tick. Solver: median, free and with a task given up.")
    console.print(f"IKTC off the cascade: {figures['iktc_off_cascade_rad']:.1e} rad at most")


def _figures(track: ArmRun) -> dict[str, dict[str, float]]:
    bound = track.task_given_up
    return {
        "error": dict(zip(arm.TASK_NAMES, np.abs(track.error).max(axis=0).tolist(), strict=True)),
        "beyond": {
            "position": max(track.max_beyond_range, 0.0),
            "velocity": _relative_excess(track.v, arm.VELOCITY),
            "acceleration": _relative_excess(track.a, arm.ACCELERATION),
        },
        "qps": {"mean": float(track.qps.mean()), "most": int(track.qps.max())},
        "solve_us": {
            "free": float(np.median(track.solve_us[~bound])),
            "bound": float(np.median(track.solve_us[bound])),
        },
    }


def _relative_excess(values: Array, limit: Array) -> float:
    return float(max((np.abs(values) / limit).max() - 1.0, 0.0))


def _qp_count(solution: Solution) -> int:
    return sum(level.needed_qp for level in solution.levels)
