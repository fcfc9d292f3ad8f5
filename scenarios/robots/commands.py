"""`sot robot new` and `sot robot check`."""

from pathlib import Path
from typing import Annotated

import typer

from scenarios.robots.check import check
from scenarios.robots.findings import print_findings, stopping
from scenarios.robots.new import new, print_evidence
from scenarios.terminal import BAD_INPUT, DONE, output

robot_app = typer.Typer(help="Make a robot file from a model, and see whether it will work.")


@robot_app.callback(invoke_without_command=True)
def _without_command(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        print(context.get_help())


@robot_app.command("new")
def robot_new_command(
    model: Annotated[Path, typer.Argument(help="A humanoid's model (.xml, .urdf).")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="File to write; MODEL.toml by default.")] = None,
) -> int:
    """Guess the robot file of a model, say how sure that is, draw it, and check it."""
    written = new(model, out)
    print_evidence(written.found, output)
    output.print(f"\nWritten: {written.file}, {written.picture}\n", soft_wrap=True)
    return robot_check_command(str(written.file))


@robot_app.command("check")
def robot_check_command(
    robot: Annotated[str, typer.Argument(metavar="FILE", help="A robot file (.toml), or a name of `sot list robots`.")],
) -> int:
    """Say all that will not work of a robot file; exit status 2 if something stops it."""
    findings = check(robot)
    print_findings(findings, output)
    return BAD_INPUT if stopping(findings) else DONE
