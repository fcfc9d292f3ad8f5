"""A scene from several seeds, a line each: `python -m scenarios.humanoidbench.trials package --seeds 5`."""

import sys
from typing import Annotated, Any

import typer

from scenarios.humanoidbench.humanoidbench import SCENES
from scenarios.humanoidbench.options import NAME, bench_options
from scenarios.replay import Replay
from scenarios.terminal import run_app

app = typer.Typer(add_completion=False)


def trial_line(scene: str, own: dict[str, Any], fell_at: float | None) -> str:
    """How a trial went, in words.

    Args:
        scene: Its name.
        own: Its figures.
        fell_at: When the robot fell [s], if it did.
    """
    end = f"fell at {fell_at:.1f} s" if fell_at is not None else "reached" if own["reached"] else "not reached"
    return f"{end}; {SCENES[scene].sentence(own)}"


@app.command()
def trials(
    scene: Annotated[str, typer.Argument(help="push, package or door.")],
    robot: Annotated[str, typer.Option("--robot", help="A name of `sot list robots`.")] = "hrp2",
    rate: Annotated[float, typer.Option(help="Control ticks per second [Hz].")] = 1000.0,
    first: Annotated[int, typer.Option(help="The first seed.")] = 1,
    seeds: Annotated[int, typer.Option(help="Number of seeds.")] = 5,
) -> None:
    """Run a scene once for each seed; nothing is written."""
    bench_options(NAME, scene, first)
    reached = 0
    for seed in range(first, first + seeds):
        danced, found = SCENES[scene].scene_run(Replay(scene, robot, rate=rate), seed, lambda what, share: None)
        reached += found["humanoidbench"]["reached"]
        print(f"seed {seed}: {trial_line(scene, found['humanoidbench'], danced.run.fell_at_s)}", flush=True)
    print(f"{reached} of {seeds} reached")


def main() -> int:
    """Run the command line; returns the exit code."""
    return run_app(app)


if __name__ == "__main__":
    sys.exit(main())
