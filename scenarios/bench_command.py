"""`sot bench`: what a tick costs, and how suites of dances go."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from scenarios.bench import benchmark_figures, read_figures
from scenarios.bench import show as show_bench
from scenarios.board.suite import BOARD
from scenarios.inputs import plant_options
from scenarios.inputs.clip_options import Clip, Duration, FrameRate, FromFormat, Start
from scenarios.inputs.run_options import Rate, RobotName, SolverName
from scenarios.peers import read_peer_figures
from scenarios.replay import Replay, check_writable, make_solver
from scenarios.robots.bench import bench_robots, robot_pieces, show_robots
from scenarios.showing import progress
from scenarios.suite import DANCES, bench_suite
from scenarios.suite import show as show_suite
from scenarios.terminal import DONE, FELL, output
from sot.errors import InputError
from sot.robots.robot import Robot

DEFAULT_ROBOT = "hrp2"
SUITES = {"dance": DANCES, "g1-reference-tracking": BOARD}


def bench_command(
    clip: Clip = "groove",
    robot: RobotName = DEFAULT_ROBOT,
    solver: SolverName = "cascade",
    start: Start = 0.0,
    duration: Duration = None,
    rate: Rate = 1000.0,
    against: Annotated[Path | None, typer.Option(help="Figures to compare with, of `sot bench --json`.")] = None,
    peer: Annotated[
        list[Path] | None,
        typer.Option(help="Figures to stand beside, of benchmarks/peer_tsid.py or peer_ticks.py; may be repeated."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The figures as JSON instead of a table.")] = False,
    suite: Annotated[
        str | None,
        typer.Option(help=f"Many clips, and a row of figures each: {', '.join(SUITES)} (a board's own protocol)."),
    ] = None,
    robots: Annotated[bool, typer.Option("--robots", help="All named robots, and a row of figures a dance.")] = False,
    feet: Annotated[str, typer.Option(help="With --suite: what `sot replay --feet` takes.")] = "auto",
    mocap: Annotated[Path | None, typer.Option(help="With --suite or --robots: a folder of more clips.")] = None,
    from_format: FromFormat = None,
    fps: FrameRate = None,
    out: Annotated[Path | None, typer.Option(help="With either: folder to keep recordings and reports in.")] = None,
    state: plant_options.StateName = "true",
    sensors: plant_options.SensorsName = "ideal",
) -> int:
    """Dance a clip and say what a tick costs, phase by phase; or dance a suite of clips and say how they went."""
    common = Replay("", robot, solver=solver, rate=rate, feet=feet, state=state, sensors=sensors, fps=fps)
    if suite is None and (state, sensors) != ("true", "ideal"):
        raise InputError("--state and --sensors: only a suite is danced on an estimated state; add --suite dance")
    if robots:
        check_writable(out or Path())
        make_solver(solver)
        dances = robot_pieces(mocap)
        with progress() as tell:
            table = bench_robots(common, dances, out, tell)
        return _shown_table(table, show_robots, as_json)
    if suite is not None:
        return _bench_suite(common, suite, mocap, from_format, out, as_json)
    if against and peer:
        raise InputError("--against and --peer: one table compares two runs, the other one shows peers; choose one")
    others = read_figures(against) if against else None
    peers = [read_peer_figures(path) for path in peer or ()]
    request = Replay(clip, robot, solver=solver, start=start, duration=duration, rate=rate)
    with progress() as tell:
        figures = benchmark_figures(request, tell) | ({"peers": peers} if peers else {})
    if as_json:
        print(json.dumps(figures, indent=2))
    else:
        show_bench(figures, output, others)
    return FELL if figures["fell"] else DONE


def _bench_suite(
    request: Replay, name: str, mocap: Path | None, from_format: str | None, out: Path | None, as_json: bool
) -> int:
    if name not in SUITES:
        raise InputError(f"unknown suite '{name}': choose one of {', '.join(SUITES)}")
    suite = SUITES[name]
    if suite.robot not in (None, request.robot) and request.robot != DEFAULT_ROBOT:
        raise InputError(f"--robot {request.robot}: the suite {name} is danced by {suite.robot}; leave it out")
    if from_format and mocap is None:
        raise InputError("--from is the format of a folder of robots' motions: name the folder with --mocap")
    request = replace(request, robot=suite.robot or request.robot, as_danced=suite.as_danced)
    check_writable(out or Path())
    make_solver(request.solver)
    request.hardware(Robot.load(request.robot))
    pieces = suite.pieces(mocap, from_format)
    with progress() as tell:
        table = bench_suite(request, pieces, out, tell, suite)
    return _shown_table(table, partial(show_suite, columns=suite.columns(request)), as_json)


def _shown_table(table: dict[str, Any], show: Callable[[dict[str, Any], Console], None], as_json: bool) -> int:
    """Print a table of dances, and say by which status it ended."""
    if as_json:
        print(json.dumps(table, indent=2))
    else:
        show(table, output)
    return DONE if table["summary"]["successes"] == table["summary"]["clips"] else FELL
