"""How much a dance takes: pushes, and what the controller is not told.

    python benchmarks/robustness.py CLIP [--impulse 8 15] [--count 20] [--seed 0] [--rate 500]
    python benchmarks/robustness.py CLIP --feet auto [--impulse 8 12]
    python benchmarks/robustness.py CLIP --mismatches

Every push acts on the chest, horizontally, for 0.1 s. A dance on planted feet is pushed at random times, begun shortly
before and followed for a while; one that steps is danced whole, and pushed at even times from its first lift to its
last landing. Mismatches are tried one at a time over the whole clip.
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
from scenarios.inputs.disturbances import spaced_pushes
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


def planted_runs(motion: Motion, impulse: float, count: int, seed: int) -> Iterator[tuple[Push, Run]]:
    """Random pushes of a dance on planted feet, and how each ended."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        t = rng.uniform(UNPUSHED_TIME, motion.duration - UNPUSHED_TIME - TIME_AFTER_PUSH)
        push = Push.horizontal(t, impulse, rng.uniform(0.0, 2.0 * np.pi))
        yield push, run_with_shipped_stack(part_around(motion, t), pushes=(replace(push, t=TIME_BEFORE_PUSH),))


def stepping_runs(motion: Motion, impulse: float, count: int) -> Iterator[tuple[Push, Run]]:
    """Pushes of a dance that steps, and how each ended."""
    first, *_, last = motion.phases
    for push in spaced_pushes(first.end, last.start, count, impulse):
        yield push, run_with_shipped_stack(motion, pushes=(push,))


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clip", help="file or name of a clip")
    parser.add_argument("--robot", default="hrp2", help="name of a robot, or its file")
    parser.add_argument("--feet", default="planted", help="planted, or auto")
    parser.add_argument("--impulse", type=float, nargs="+", default=[8.0, 15.0], help="of the pushes [N s]")
    parser.add_argument("--count", type=int, default=20, help="pushes of each impulse")
    parser.add_argument("--seed", type=int, default=0, help="of times and directions")
    parser.add_argument("--rate", type=float, default=500.0, help="of the control [Hz]")
    parser.add_argument("--mismatches", action="store_true", help="try these, and no pushes")
    args = parser.parse_args()
    motion = plan(recognise(read(find_clip(args.clip))), Robot.load(args.robot), args.feet, args.rate).motion
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
        runs = (
            stepping_runs(motion, impulse, args.count)
            if len(motion.phases) > 1
            else planted_runs(motion, impulse, args.count, args.seed)
        )
        for push, ended in runs:
            if ended.fell_at_s is not None:
                falls.append(f"t = {push.t:.2f} s, {np.degrees(push.direction):.0f}°: {ended.reason}")
        console.print(f"{impulse:g} N s: {args.count - len(falls)} of {args.count} survived")
        for fall in falls:
            console.print(f"  fell: {fall}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
