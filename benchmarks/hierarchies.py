"""The cascade against other ways to solve the same hierarchies: those of the ticks of a dance, in one process.

    python benchmarks/hierarchies.py [--clip groove] [--ticks 400] [--json]

- cascade: ours, with what it remembers from tick to tick.
- daqp: DAQP's own hierarchical mode (`break_points`) on the same rows.
- daqp, reduced: the same in the variables that level 0's equalities leave (`solvers.reduction`, whose time counts).
- chain of QPs: one exact QP a level through `qpsolvers`, for each back end that is installed.

The answers are compared by the violation of each level, relative to the scale of its rows.
"""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import daqp
import numpy as np
import qpsolvers
from rich.console import Console
from rich.table import Table

from scenarios import stacks
from scenarios.replay import Replay, retarget
from sim.reference import hot_reference_us
from sim.world import World
from solvers import Cascade, Level
from solvers.reduction import Reduction, leading_count
from sot.control.controller import Controller
from sot.robots.robot import Robot

Array = np.ndarray
BACK_ENDS = ("proxqp", "quadprog", "daqp", "piqp")
DAQP_EQUALITY = 5  # DAQP's word for it


class RecordingSolver:
    """A solver that keeps copies of what it is given."""

    name = "recorded"

    def __init__(self, every: int) -> None:
        self.levels: list[list[Level]] = []
        self._cascade, self._every, self._count = Cascade(), every, 0

    def solve(self, levels):
        if self._count % self._every < 2:  # two in a row, so that the second finds its solver warm
            self.levels.append([_copied(level) for level in levels])
        self._count += 1
        return self._cascade.solve(levels)


def _copied(level: Level) -> Level:
    equalities = [replace(e, A=e.A.copy(), b=e.b.copy()) for e in level.equalities]
    return Level(
        level.name, level.size, equalities, level.C.copy(), level.lower.copy(), level.upper.copy(), level.blocks
    )


def solve_with_daqp(levels: Sequence[Level]) -> Array:
    """x of DAQP's hierarchical mode."""
    A = np.vstack([part for level in levels for part in (level.C, level.A)])
    upper = np.concatenate([part for level in levels for part in (level.upper, level.b)])
    lower = np.concatenate([part for level in levels for part in (level.lower, level.b)])
    ends = np.cumsum([len(level.lower) + len(level.b) for level in levels]).astype(np.int32)
    sense = np.zeros(len(upper), dtype=np.int32)
    sense[len(levels[0].lower) : ends[0]] = DAQP_EQUALITY
    x, _, status, _ = daqp.solve(None, None, A, upper, lower, sense, ends)
    return x if status > 0 else np.full(levels[0].size, np.nan)


def solve_reduced_with_daqp(levels: Sequence[Level]) -> Array:
    """The same without level 0's equalities."""
    reduction = Reduction.of(levels[0], leading_count(levels), 1e-7)
    assert reduction is not None
    return reduction.full_solution(solve_with_daqp(reduction.reduced_levels(levels)))


def qp_chain_solver(back_end: str) -> Callable[[Sequence[Level]], Array]:
    """One exact QP a level in (x, w); what a level has reached is an equality of those below."""

    def solve(levels: Sequence[Level]) -> Array:
        n, hard = levels[0].size, levels[0]
        G, h = np.vstack([hard.C, -hard.C]), np.concatenate([hard.upper, -hard.lower])
        G, h = G[np.isfinite(h)], h[np.isfinite(h)]
        A, b, x = hard.A, hard.b, np.zeros(n)
        for level in levels[1:]:
            P = level.A.T @ level.A + 1e-8 * np.eye(n)
            problem = qpsolvers.Problem(P, -level.A.T @ level.b, G, h, A, b)
            solution = qpsolvers.solve_problem(problem, solver=back_end)
            if not solution.found:
                return np.full(n, np.nan)
            x = solution.x
            A, b = np.vstack([A, level.A]), np.concatenate([b, level.A @ x])
            Q, R, _ = _independent_rows(A)
            A, b = R, Q.T @ b
        return x

    return solve


def _independent_rows(A: Array) -> tuple[Array, Array, Array]:
    """Orthonormal combinations of rows without those that others imply, as many back ends want them."""
    U, s, Vt = np.linalg.svd(A, full_matrices=False)
    keep = s > 1e-9 * s[0]
    return U[:, keep], s[keep, None] * Vt[keep], s


def excess_violation(levels: Sequence[Level], x: Array, reference: Array) -> float:
    """Largest amount by which a level is violated more than in the reference answer, over 1 + its right-hand side."""
    if not np.isfinite(x).all():
        return np.inf
    worst = float(np.abs(levels[0].violation(x)).max())
    for level in levels[1:]:
        scale = 1.0 + float(np.abs(level.b).max(initial=0.0))
        more = np.linalg.norm(level.violation(x)) - np.linalg.norm(level.violation(reference))
        worst = max(worst, float(more) / scale)
        if more < -1e-6 * scale:  # a level above gave more away: what follows says nothing
            break
    return worst


def times_and_answers(
    ticks: Sequence[Sequence[Level]], solve: Callable[[Sequence[Level]], Array]
) -> tuple[Array, list[Array]]:
    """Times [µs] and answers."""
    times, answers = np.empty(len(ticks)), []
    for k, levels in enumerate(ticks):
        fresh = [replace(level, _A=None, _b=None) for level in levels]
        start = perf_counter()
        answers.append(solve(fresh))
        times[k] = 1e6 * (perf_counter() - start)
    return times, answers


def recorded_ticks(clip: str, count: int) -> list[list[Level]]:
    """Levels of ticks spread over a dance."""
    robot = Robot.load("hrp2")
    with TemporaryDirectory() as folder:
        request = Replay(clip, feet="planted")
        motion = retarget(request, Path(folder) / "motion.npz", lambda what, share: None).motion
    total = round(motion.duration * 1000.0)
    recorder = RecordingSolver(max(2, 2 * total // count))
    controller, world = Controller(robot, stacks.planted_stack(robot, motion), recorder), World(robot)
    world.reset(motion.q[0], motion.v[0])
    for k in range(total):
        world.step(controller(0.001 * k, *world.state()).torque)
    return recorder.levels


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--clip", default="groove", help="a clip that is danced with planted feet")
    parser.add_argument("--ticks", type=int, default=400, help="how many of its ticks are solved")
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    args = parser.parse_args()
    ticks = recorded_ticks(args.clip, args.ticks)
    cascade = Cascade()
    solvers = {
        "cascade": lambda levels: cascade.solve(levels).x,
        "daqp": solve_with_daqp,
        "daqp, reduced": solve_reduced_with_daqp,
        **{f"chain of QPs, {name}": qp_chain_solver(name) for name in BACK_ENDS if name in qpsolvers.available_solvers},
    }
    figures = {}
    reference: list[Array] = []
    for name, solve in solvers.items():
        times, answers = times_and_answers(ticks, solve)
        reference = reference or answers
        off = [excess_violation(levels, x, best) for levels, x, best in zip(ticks, answers, reference, strict=True)]
        figures[name] = {
            "p50_us": float(np.median(times)),
            "p99_us": float(np.percentile(times, 99)),
            "solved": float(np.mean(np.isfinite(off))),
            "worse_max": float(np.max(np.array(off)[np.isfinite(off)], initial=0.0)),
        }
    result = {"clip": args.clip, "ticks": len(ticks), "reference_us": hot_reference_us(), "solvers": figures}
    if args.json:
        json.dump(result, sys.stdout, indent=2)
        return 0
    table = Table(box=None, padding=(0, 2, 0, 0))
    for head in ("", "p50 [µs]", "p99 [µs]", "ratio", "solved", "worse by"):
        table.add_column(head, justify="left" if not head else "right", no_wrap=True)
    for name, row in figures.items():
        share = row["p50_us"] / figures["cascade"]["p50_us"]
        table.add_row(
            *(name, f"{row['p50_us']:.0f}", f"{row['p99_us']:.0f}", f"{share:.2f}"),
            *(f"{100 * row['solved']:.1f} %", f"{row['worse_max']:.1e}"),
        )
    console = Console()
    console.print(f"{args.clip}: {len(ticks)} ticks, reference computation {result['reference_us']:.0f} µs")
    console.print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
