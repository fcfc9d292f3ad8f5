"""How the cascade's time grows with levels, contacts and degrees of freedom, and whether its memory does.

    python benchmarks/growth.py [--repeats 200] [--minutes 0] [--json]

Hierarchies are random but shaped like a tick's: contacts of six rows and twelve forces each, six coupled rows, bounds
on everything, levels of three rows, a posture, least forces. `--minutes` lets a robot dance under physics for that
long, in simulated time, and prints the memory in use: but for the log it should not change.
"""

import argparse
import json
import sys
from dataclasses import fields
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.inputs.clips import find_clip
from scenarios.stacks import planted_stack
from sim.log import RunLog
from sim.loop import run
from sim.reference import hot_reference_us
from sim.world import World
from solvers import Cascade, Level
from solvers.rows import Equality
from sot.control.controller import Controller
from sot.motion import plan, read, recognise
from sot.robots.robot import Robot

Array = np.ndarray
DEFAULT_SIZES = {"levels": 5, "contacts": 2, "dofs": 36}
SIZE_SERIES = {"levels": range(1, 9), "contacts": range(1, 5), "dofs": range(20, 61, 10)}
ROWS_PER_LEVEL = 3  # of each level but the last two


def hierarchy(rng: np.random.Generator, levels: int, contacts: int, dofs: int) -> list[Level]:
    """A hierarchy with that many levels below level 0; with one or two, posture and forces come first."""
    forces = 12 * contacts
    n, J = dofs + forces, rng.normal(size=(min(6 * contacts, dofs - 8), dofs))
    inside = rng.normal(size=n)
    coupled = rng.normal(size=(6, n))
    equalities = [Equality(J, J @ inside[:dofs]), Equality(coupled, coupled @ inside)]
    box, width = np.eye(n), np.append(np.full(dofs, 1e3), np.full(forces, 30.0))
    none = np.zeros((0, n)), np.zeros(0), np.zeros(0)
    soft = [
        Level(
            f"task {k}", n, [Equality(rng.normal(size=(ROWS_PER_LEVEL, dofs)), rng.normal(size=ROWS_PER_LEVEL))], *none
        )
        for k in range(min(levels - 2, (dofs - len(J) - 1) // ROWS_PER_LEVEL))
    ]
    posture = Equality(np.eye(dofs), rng.normal(size=dofs), 1.0, 0, slice(0, dofs))
    least = Equality(np.eye(forces), np.zeros(forces), 0.1, dofs, slice(0, forces))
    last = [Level("posture", n, [posture], *none), Level("forces", n, [least], *none)]
    return [Level("hard", n, equalities, box, -width, width), *soft, *last[:levels]]


def median_solve_times(repeats: int) -> dict[str, dict[int, float]]:
    """Median time of a solve [µs] along each series, the other sizes as in BASE."""
    out: dict[str, dict[int, float]] = {}
    for name, values in SIZE_SERIES.items():
        out[name] = {}
        for value in values:
            rng, cascade, times = np.random.default_rng(0), Cascade(), []
            for _ in range(repeats):
                levels = hierarchy(rng, **(DEFAULT_SIZES | {name: value}))
                start = perf_counter()
                cascade.solve(levels)
                times.append(1e6 * (perf_counter() - start))
            out[name][value] = float(np.median(times))
    return out


def memory_growth(minutes: float) -> dict[str, Any]:
    """Memory of a process that dances groove under physics again and again, with one controller in one world.

    Returns:
        "readings", simulated time [s] and resident memory [MB] after each dance, its log freed; "slope_mb_min" of
        their second half; "log_mb_s" that a log takes as long as it is kept.
    """
    robot = Robot.load("hrp2")
    motion = plan(recognise(read(find_clip("groove"))), robot).motion
    controller, world = Controller(robot, planted_stack(robot, motion), Cascade()), World(robot)
    readings: list[tuple[float, float]] = []
    while len(readings) * motion.duration < 60.0 * minutes:
        done = run(controller, world, motion)
        if done.fell_at_s is not None:
            sys.exit(f"fell in dance {len(readings) + 1}, at {done.fell_at_s:.1f} s: {done.reason}")
        log_mb = (
            sum(getattr(done.log, column.name).nbytes for column in fields(RunLog) if column.type is np.ndarray) / 1e6
        )
        del done
        readings.append(((len(readings) + 1) * motion.duration, _resident_mb()))
    times, sizes = np.array(readings[len(readings) // 2 :]).T
    slope = 60.0 * float(np.polyfit(times, sizes, 1)[0]) if len(times) > 1 else 0.0
    return {"readings": readings, "slope_mb_min": slope, "log_mb_s": log_mb / motion.duration}


def _resident_mb() -> float:
    """Memory that the process holds [MB]."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * 4096 / 1e6


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=200, help="hierarchies of each size")
    parser.add_argument("--minutes", type=float, default=0.0, help="how long to dance and watch the memory (Linux)")
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    args = parser.parse_args()
    result: dict[str, Any] = {"reference_us": hot_reference_us(), "p50_us": median_solve_times(args.repeats)}
    if args.minutes:
        result["memory"] = memory_growth(args.minutes)
    if args.json:
        json.dump(result, sys.stdout, indent=2)
        return 0
    console = Console()
    console.print(f"Cascade.solve, median [µs]; reference computation {result['reference_us']:.0f} µs")
    for name, times in result["p50_us"].items():
        table = Table(box=None, padding=(0, 2, 0, 0))
        for head in (name, *(str(value) for value in times)):
            table.add_column(head, justify="right")
        table.add_row("", *(f"{time:.0f}" for time in times.values()))
        console.print(table)
    if grew := result.get("memory"):
        for t, size in grew["readings"]:
            console.print(f"after {t:6.0f} s: {size:.1f} MB")
        slope, log = grew["slope_mb_min"], grew["log_mb_s"]
        console.print(f"slope of the second half {slope:.3f} MB a minute; a log takes {log:.2f} MB a second while kept")
    return 0


if __name__ == "__main__":
    sys.exit(main())
