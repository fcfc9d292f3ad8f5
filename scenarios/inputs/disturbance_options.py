"""Options of the command line on what disturbs a run: pushes, and what the controller is not told."""

from typing import Annotated

import typer

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
