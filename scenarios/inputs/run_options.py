"""Options of the commands that run a robot."""

from typing import Annotated

import typer

RobotName = Annotated[str, typer.Option("--robot", help="A name of `sot list robots`, or a robot file (.toml).")]
SolverName = Annotated[str, typer.Option("--solver", help="A name of `sot list solvers`.")]
Rate = Annotated[float, typer.Option(help="Control ticks per second.", min=100.0, max=2000.0)]
Pushes = Annotated[
    list[str] | None,
    typer.Option("--push", help='A push, like "t=5 force=80,0,0 duration=0.1 body=chest" [s, N]; may be repeated.'),
]
MismatchText = Annotated[
    str,
    typer.Option(
        "--mismatch",
        help='What the controller is not told, like "mass=1.1 damping=2 delay=0.002 noise=0.05 friction=0.5 seed=1".',
    ),
]
