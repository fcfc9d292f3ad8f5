"""Moments of a box that is carried, side by side.

`python -m scenarios.otani2017.carrying.picture carry.png --mass 5`
"""

import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from scenarios.otani2017.carrying.carry import Carrying, perform
from scenarios.otani2017.scene import ObjectOptions
from scenarios.replay import Replay
from scenarios.terminal import run_app
from sim.recording.stills import write_stills

MOMENTS = 4
app = typer.Typer(add_completion=False)


@app.command()
def picture(
    file: Annotated[Path, typer.Argument(help="Picture to write (.png).")],
    robot: Annotated[str, typer.Option("--robot", help="A robot with palms.")] = "hrp2",
    rate: Annotated[float, typer.Option(help="Control ticks per second [Hz].")] = 1000.0,
    mass: Annotated[float, typer.Option(help="Of the box [kg].")] = 2.0,
    seed: Annotated[int | None, typer.Option(help="Of the noise of the box's place; none without.")] = None,
) -> None:
    """Carry a box, and draw the robot when it takes it, twice on its way, and when it lets it go."""
    done = perform(
        Replay("", robot, rate=rate), Carrying(ObjectOptions(mass=mass), seed=seed), lambda what, share: None
    )
    holding = [t for t, sets in done.schedule.history if sets.holding]
    over = [t for t, sets in done.schedule.history if not sets.holding and t > holding[0]]
    end = over[0] if over else float(done.danced.run.log.trimmed().time[-1])
    write_stills(file, done.danced.run.log.trimmed(), done.system, np.linspace(holding[0], end, MOMENTS).tolist())
    print(f"{file}: {MOMENTS} moments from {holding[0]:.1f} to {end:.1f} s")


def main() -> int:
    """Run the command line; returns the exit code."""
    return run_app(app)


if __name__ == "__main__":
    sys.exit(main())
