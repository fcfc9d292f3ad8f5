"""What `sot batch` reaches of two loops over single clips, on 60 short clips.

    python benchmarks/batch_throughput.py OUT [--mocap FOLDER] [--robot g1] [--clips 60] [--rounds 5] [--json]

The clips are pieces of the named ones, of grooves of other tempi, and of a folder's; OUT/clips.txt lists them. Batch
and loops take the same clips in turn, some of them a round; each way has two processes of one thread, which it starts
itself. OUT/library is what one batch of all would leave. On a machine that others use too, the processors' time that
both ways took says more than the wall's.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

from scenarios.inputs.clips import named_clips
from scenarios.inputs.groove import groove_bvh
from scenarios.library.batch import Batch, run_batch
from scenarios.library.clip_list import find_clips
from scenarios.library.job import OUTCOMES
from scenarios.library.table import read_rows
from scenarios.library.worker import VARIABLES
from scenarios.replay import Replay, replay
from sot.errors import InputError
from sot.motion import read

PIECE_S, PROCESSES = 2.0, 2
NAMED = {"lafan1_dance1_subject2": 16, "lafan1_aiming": 12, "kick": 4, "cmu_01_01": 4, "groove": 4}
TEMPI, PIECES_OF_A_TEMPO = (0.8, 0.9, 1.1, 1.2), 3  # of grooves, of the clip's own
MAX_PIECES_OF_A_FILE = 3
RATE_HZ = 500.0
LOOP = "loop"  # first argument of a process that goes through a list by itself


class Times(NamedTuple):
    """Wall and processors' time that something took [s]."""

    wall_s: float
    cpu_s: float


def clip_lines(folder: Path, mocap: Path | None) -> list[str]:
    """Lines of a list in a folder, each a clip, start and length of its piece; other grooves are written there."""
    lines = [line for clip in named_clips() for line in _pieces(clip.name, clip.seconds, NAMED.get(clip.name, 0))]
    frame_time = next(line for line in groove_bvh().splitlines() if line.startswith("Frame Time:"))
    for tempo in TEMPI:
        own = folder / f"groove_{100 * tempo:.0f}.bvh"
        slower = f"Frame Time: {float(frame_time.split(':')[1]) / tempo:.6f}"
        own.write_text(groove_bvh().replace(frame_time, slower), encoding="ascii")
        lines += _pieces(own.name, read(own).duration, PIECES_OF_A_TEMPO)
    for file in sorted(mocap.glob("*.bvh")) if mocap else []:
        lines += _pieces(os.path.relpath(file, folder), read(file).duration, MAX_PIECES_OF_A_FILE)
    return lines


def run_in_batch(lines: Sequence[str], out: Path, robot: str) -> None:
    """A batch of clips, into the library."""
    source = _list_file(out / "clips_of_a_round.txt", lines)
    run_batch(Batch(str(source), out / "library", Replay("", robot, feet="auto", rate=RATE_HZ), workers=PROCESSES))


def run_in_loops(lines: Sequence[str], out: Path, robot: str) -> None:
    """Two processes that go through half of the clips each, one after another."""
    loops = []
    for k in range(PROCESSES):
        source = _list_file(out / f"clips_of_loop_{k}.txt", lines[k::PROCESSES])
        command = [sys.executable, __file__, LOOP, str(source), str(out / "loops"), robot]
        loops.append(subprocess.Popen(command, env=os.environ | VARIABLES))
    if any([loop.wait() for loop in loops]):
        raise RuntimeError("a loop ended with an error")


def times_of(way: Callable[[Sequence[str], Path, str], None], lines: Sequence[str], out: Path, robot: str) -> Times:
    """What a way took, with its processes."""
    wall, cpu = perf_counter(), _processor_time()
    way(lines, out, robot)
    return Times(perf_counter() - wall, _processor_time() - cpu)


def run_loop(source: str, out: Path, robot: str) -> None:
    """Dance the clips of a list one after another, each into a folder of its own."""
    for clip in find_clips(source):
        request = Replay(clip.clip, robot, feet="auto", start=clip.start, duration=clip.duration, rate=RATE_HZ)
        try:
            replay(request, out / clip.key, lambda what, share: None)
        except InputError as refusal:
            print(f"{clip.key}: {refusal}", file=sys.stderr)


def compared(out: Path, mocap: Path | None, robot: str, count: int, rounds: int) -> dict[str, Any]:
    """Times of both ways round by round, and what the library came to."""
    out.mkdir(parents=True)
    every = clip_lines(out, mocap)
    lines = [every[k * len(every) // count] for k in range(min(count, len(every)))]
    _list_file(out / "clips.txt", lines)
    told: list[dict[str, Any]] = []
    for k in range(rounds):
        own = lines[k::rounds]
        ways = [("batch", run_in_batch), ("loops", run_in_loops)]
        took = {name: times_of(way, own, out, robot) for name, way in (ways if k % 2 else reversed(ways))}
        ratios = {
            "wall_ratio": took["loops"].wall_s / took["batch"].wall_s,
            "cpu_ratio": took["loops"].cpu_s / took["batch"].cpu_s,
        }
        told.append({"clips": len(own)} | {name: times._asdict() for name, times in took.items()} | ratios)
        print(f"round {k + 1}: {told[-1]}", file=sys.stderr, flush=True)
    rows = read_rows(out / "library")
    return {
        "rounds": told,
        **{name: median(one[name] for one in told) for name in ("wall_ratio", "cpu_ratio")},
        "outcomes": {name: sum(row["outcome"] == name for row in rows) for name in OUTCOMES},
    }


def _processor_time() -> float:
    """Of this process and of those that it has started and that have ended [s]."""
    used = [resource.getrusage(whose) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def _pieces(name: str, seconds: float, count: int) -> Iterator[str]:
    """Lines for pieces of a clip, evenly from its start to its end."""
    for k in range(count):
        yield f"{name}\t{(seconds - PIECE_S) * k / max(1, count - 1):.1f}\t{PIECE_S:g}"


def _list_file(path: Path, lines: Sequence[str]) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--mocap", type=Path)
    parser.add_argument("--robot", default="hrp2")
    parser.add_argument("--clips", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", action="store_true")
    told = parser.parse_args()
    figures = compared(told.out, told.mocap, told.robot, told.clips, told.rounds)
    if told.json:
        print(json.dumps(figures, indent=2))
    else:
        print(
            f"sot batch reaches {figures['wall_ratio']:.2f} of two loops, {figures['cpu_ratio']:.2f} by the processors'"
            f" time; {figures['outcomes']}"
        )


if __name__ == "__main__":
    if sys.argv[1:2] == [LOOP]:
        run_loop(sys.argv[2], Path(sys.argv[3]), sys.argv[4])
    else:
        main()
