"""How much a dance on planted feet takes: random pushes, and what the controller is not told.

    python benchmarks/robustness.py CLIP [--impulse 8 15] [--count 20] [--seed 0] [--rate 500]
    python benchmarks/robustness.py CLIP --mismatches

Every push acts on the chest, horizontally, for 0.1 s; the dance is begun shortly before it and followed for a while.
Mismatches are tried one at a time over the whole clip.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios import stacks
from scenarios.inputs.clips import find_clip
from sim.loop import Run, run
from sim.mismatch import NO_MISMATCH, Mismatch
from sim.push import Push
from sim.reporting import figures
from sim.world import World
from solvers import Cascade
from sot.control.controller import Controller
from sot.motion import read, recognise
from sot.motion.plan import plan
from sot.motion.trajectory import SAVED_FIELDS, Motion
from sot.robots.robot import Robot

TIME_BEFORE_PUSH, TIME_AFTER_PUSH = 0.4, 2.6  # s of the dance before and after the beginning of a push
UNPUSHED_TIME = 2.0  # s at both ends of the clip in which nobody is pushed
MISMATCHES = {
    "none": NO_MISMATCH,
    "mass +10 %": Mismatch(mass=1.1),
    "damping doubled": Mismatch(damping=2.0),
    "torques 2 ms late": Mismatch(delay=0.002),
    "noise 0.05 rad/s": Mismatch(noise=0.05),
    "friction 0.5": Mismatch(friction=0.5),
}


def part_around(motion: Motion, t: float) -> Motion:
    """The part of a motion on planted feet around a time [s]."""
    rows = slice(round((t - TIME_BEFORE_PUSH) * motion.rate), round((t + TIME_AFTER_PUSH) * motion.rate) + 1)
    parts = {name: getattr(motion, name)[rows] for name in SAVED_FIELDS}
    phase = replace(motion.phases[0], start=0.0, end=TIME_BEFORE_PUSH + TIME_AFTER_PUSH)
    return Motion(motion.robot, motion.rate, **parts, phases=(phase,))


def run_with_shipped_stack(motion: Motion, mismatch: Mismatch = NO_MISMATCH, pushes: tuple[Push, ...] = ()) -> Run:
    """Run the shipped stack on a motion."""
    robot, period = motion.robot, 1.0 / motion.rate
    stack, schedule = stacks.stepping_stack(robot, motion), stacks.stepping_schedule(robot, motion)
    controller = Controller(robot, stack, Cascade(), period, schedule)
    return run(controller, World(robot, period, mismatch, pushes), motion)


def runs_with_pushes(motion: Motion, impulse: float, count: int, seed: int) -> Iterator[tuple[float, float, Run]]:
    """Time [s] and direction [rad] of random pushes, and how each ended."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        t, direction = (
            rng.uniform(UNPUSHED_TIME, motion.duration - UNPUSHED_TIME - TIME_AFTER_PUSH),
            rng.uniform(0.0, 2.0 * np.pi),
        )
        force = impulse / 0.1 * np.array([np.cos(direction), np.sin(direction), 0.0])
        yield (
            t,
            direction,
            run_with_shipped_stack(part_around(motion, t), pushes=(Push(TIME_BEFORE_PUSH, tuple(force.tolist())),)),
        )


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clip", help="file or name of a clip")
    parser.add_argument("--robot", default="hrp2", help="name of a robot, or its file")
    parser.add_argument("--impulse", type=float, nargs="+", default=[8.0, 15.0], help="of the pushes [N s]")
    parser.add_argument("--count", type=int, default=20, help="pushes of each impulse")
    parser.add_argument("--seed", type=int, default=0, help="of times and directions")
    parser.add_argument("--rate", type=float, default=500.0, help="of the control [Hz]")
    parser.add_argument("--mismatches", action="store_true", help="try these, and no pushes")
    args = parser.parse_args()
    motion = plan(recognise(read(find_clip(args.clip))), Robot.load(args.robot), "planted", args.rate).motion
    console = Console(width=None if sys.stdout.isatty() else 120)
    if args.mismatches:
        table = Table("", "ending", "zmp inside, %", "slip, mm", "infeasible ticks", box=None, padding=(0, 2, 0, 0))
        for name, mismatch in MISMATCHES.items():
            ended = run_with_shipped_stack(motion, mismatch)
            log = ended.log.trimmed()
            table.add_row(
                *(name, "upright" if ended.fell_at_s is None else f"fell at {ended.fell_at_s:.1f} s"),
                f"{100 * figures.zmp(log, motion)['inside']:.1f}",
                f"{1e3 * figures.contacts(log, motion)['slip_max_m']:.1f}",
                str(figures.solver(log)["infeasible_ticks"]),
            )
        console.print(table)
        return 0
    for impulse in args.impulse:
        falls = []
        for t, direction, ended in runs_with_pushes(motion, impulse, args.count, args.seed):
            if ended.fell_at_s is not None:
                falls.append(f"t = {t:.2f} s, {np.degrees(direction):.0f}°: {ended.reason}")
        console.print(f"{impulse:g} N s: {args.count - len(falls)} of {args.count} survived")
        for fall in falls:
            console.print(f"  fell: {fall}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
