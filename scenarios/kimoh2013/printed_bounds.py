"""Kim (14) as printed beside the viable form of it: random joints, run into the ends of their ranges at any period.

The state after a period that takes ``w = √(2 a d)`` towards an end at the distance d, at the speed w, is at
``d − w T``. Kim (14) then asks for a speed of ``√(2 a (d − w T))`` at most, and allows ``w − a T`` at least; squared,
``w² − 2 a w T`` and ``w² − 2 a w T + a² T²``. However small the period T, who rides the bound is left with nothing.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.replay import ProgressCallback
from sim.reporting.chart import Curve, Panel, write_panels
from tasks.bounds import AccelerationBounds

Array = np.ndarray
Bounds = Callable[[Array, Array, float], tuple[Array, Array]]
AccelerationChoice = Callable[[Array, Array, Array, Array], Array]
"""Function that chooses accelerations from: lower bounds, upper bounds, joints with empty bounds, stopping
accelerations."""

JOINT_COUNT = 2000
PERIODS = (0.0002, 0.001, 0.002, 0.005, 0.01)
RUN_DURATION = 1.0
FORM_NAMES = ("as printed", "viable")
PICTURE_FILE = "bounds.svg"
BOUND_TOLERANCE = 1e-9


class PrintedBounds:
    """Kim (14) to the letter.

    Args:
        lower, upper: Range, shapes (n,) [rad].
        velocity, acceleration: Symmetric limits, shapes (n,) [rad/s, rad/s²].
    """

    def __init__(self, lower: Array, upper: Array, velocity: Array, acceleration: Array) -> None:
        self.lower, self.upper, self.velocity, self.acceleration = lower, upper, velocity, acceleration

    def __call__(self, q: Array, v: Array, period: float) -> tuple[Array, Array]:
        """b_l and b_u at a state, shapes (n,). Nothing lies between where b_l > b_u; nan outside the range."""
        a = self.acceleration
        with np.errstate(invalid="ignore"):
            up = np.fmin(self.velocity, np.sqrt(2.0 * a * (self.upper - q)))
            down = np.fmin(self.velocity, np.sqrt(2.0 * a * (q - self.lower)))
            up, down = np.where(q > self.upper, np.nan, up), np.where(q < self.lower, np.nan, down)
        return np.maximum(-a, (-down - v) / period), np.minimum(a, (up - v) / period)


def study(rate: float, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Measure both forms, and draw one joint that is driven into the end of its range.

    Args:
        rate: Of the joint that is drawn [Hz].
        out: Folder for the picture.
        tell: Told of the progress.
    """
    figures = {}
    for k, period in enumerate(PERIODS):
        tell("measuring", k / len(PERIODS))
        figures[f"{1e3 * period:g}"] = compare_forms(period)
    _draw(out / PICTURE_FILE, 1.0 / rate)
    return {"scenario": "bounds", "joints": JOINT_COUNT, "seconds": RUN_DURATION, "period_ms": figures}


def compare_forms(period: float, joints: int = JOINT_COUNT) -> dict[str, dict[str, float]]:
    """Figures of both forms at a period [s], from the same starts.

    Returns:
        Of each form: the share of joints that are left with nothing to choose if they take any acceleration between the
        bounds ("random"), and if they take the largest ("driven"); of the latter, the share that leaves its range
        ("left") and by how much at most ("beyond_rad") if it then brakes as hard as it may, and the acceleration over
        its limit that it takes at most if it obeys the bound of the speed instead ("needed").
    """
    rng = np.random.default_rng(14)
    lower = rng.uniform(-2.0, 1.0, joints)
    upper = lower + rng.uniform(0.5, 3.0, joints)
    velocity, a = rng.uniform(1.0, 10.0, joints), rng.uniform(10.0, 100.0, joints)
    q = rng.uniform(lower, upper)
    most = [_max_stoppable_speed(distance, a, period, velocity) for distance in (q - lower, upper - q)]
    v = rng.uniform(-most[0], most[1])
    forms: tuple[Bounds, Bounds] = (
        PrintedBounds(lower, upper, velocity, a),
        AccelerationBounds(lower, upper, velocity, a, a),
    )
    figures = {}
    for name, bounds in zip(FORM_NAMES, forms, strict=True):

        def run(choose: AccelerationChoice, bounds: Bounds = bounds) -> tuple[Array, Array, Array]:
            return _run_joints(bounds, choose, q, v, upper, a, period)

        wandering, _, _ = run(
            lambda low, high, empty, stop: np.where(empty, stop, low + rng.random(joints) * (high - low))
        )
        driven, beyond, _ = run(lambda low, high, empty, stop: np.where(empty, stop, high))
        _, _, hardest = run(lambda low, high, empty, stop: np.where(np.isfinite(high), high, stop))
        figures[name] = {
            "random": float(np.mean(wandering)),
            "driven": float(np.mean(driven)),
            "left": float(np.mean(beyond > BOUND_TOLERANCE)),
            "beyond_rad": float(np.maximum(beyond, 0.0).max()),
            "needed": float(np.max(hardest / a)),
        }
    return figures


def _max_stoppable_speed(distance: Array, a: Array, period: float, velocity: Array) -> Array:
    """Largest speed from which braking for whole periods stops within a distance; Kim (15) holds for it too."""
    half = 0.5 * a * period
    return np.minimum(np.sqrt(half**2 + 2.0 * a * distance) - half, velocity)


def _run_joints(
    bounds: Bounds, choose: AccelerationChoice, q: Array, v: Array, upper: Array, a: Array, period: float
) -> tuple[Array, Array, Array]:
    """Whether each joint is left with empty bounds, its largest excess over `upper`, and its hardest braking."""
    empty, beyond, hardest = np.zeros(len(q), dtype=bool), np.full(len(q), -np.inf), np.zeros(len(q))
    for _ in range(round(RUN_DURATION / period)):
        low, high = bounds(q, v, period)
        empty |= ~(low <= high + BOUND_TOLERANCE)
        stop = np.clip(-v / period, -a, a)
        chosen = choose(low, high, empty, stop)
        hardest = np.where(np.isfinite(high), np.maximum(hardest, -chosen), hardest)
        # On the way a joint is furthest where it turns, if it does within the period.
        turn = np.clip(np.divide(-v, chosen, out=np.zeros_like(v), where=chosen < 0.0), 0.0, period)
        beyond = np.maximum(beyond, q + v * turn + 0.5 * chosen * turn**2 - upper)
        q, v = q + v * period + 0.5 * chosen * period**2, v + chosen * period
        beyond = np.maximum(beyond, q - upper)
    return empty, beyond, hardest


def show(figures: dict[str, Any], console: Console) -> None:
    """Print the figures as a table."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in (
        *("period\nms", "Kim (14)", "nothing left\nat random", "\ndriven", "range\nleft", "by at most\nmrad"),
        "or braking\na_max",
    ):
        table.add_column(words, justify="right")
    for period, forms in figures["period_ms"].items():
        for name, form in forms.items():
            shares = (f"{100.0 * form[key]:.0f} %" for key in ("random", "driven", "left"))
            table.add_row(period, name, *shares, f"{round(1e3 * form['beyond_rad'], 6):.3g}", f"{form['needed']:.2f}")
    console.print(table)


def _draw(path: Path, period: float) -> None:
    """One joint of the paper's arm, driven into the end of its range at half a radian's distance."""
    limit, velocity, a = np.zeros(1), np.full(1, np.pi), np.full(1, 10.0 * np.pi)
    forms: tuple[Bounds, Bounds] = (
        PrintedBounds(limit - 9.0, limit, velocity, a),
        AccelerationBounds(limit - 9.0, limit, velocity, a, a),
    )
    tracks = []
    for bounds in forms:
        q, v, rows = limit - 0.5, limit.copy(), []
        for _ in range(round(0.45 / period)):
            low, high = bounds(q, v, period)
            rows.append([float(part[0]) for part in (q, v, low, high)])
            chosen = np.where(np.isfinite(high), high, -a)
            q, v = q + v * period + 0.5 * chosen * period**2, v + chosen * period
        tracks.append(np.array(rows))
    t, colors = np.arange(len(tracks[0])) * period, ("#d9762b", "#2b6fd9")
    both = list(zip(FORM_NAMES, colors, tracks, strict=True))
    edge = Curve(t[[0, -1]], np.full(2, -a[0]), "#c33", "-a_max", dashed=True, width=1.0)
    panels = [
        Panel("Position, its limit 0", "s", "rad", [Curve(t, rows[:, 0], color, name) for name, color, rows in both]),
        Panel("Speed", "s", "rad/s", [Curve(t, rows[:, 1], color, name) for name, color, rows in both]),
        Panel(
            "Largest acceleration allowed",
            "s",
            "rad/s²",
            [*(Curve(t, rows[:, 3], color, name) for name, color, rows in both), edge],
        ),
    ]
    write_panels(path, f"A joint driven into the end of its range, Kim (14), period {1e3 * period:g} ms", panels, 3)
