"""The bag again and again: off its place, on a table that is lower than told, or slippery under the palm.

`python -m scenarios.otani2017.bag.trials --seeds 5 --lower 0.02 --palm-friction 0.4`
"""

import sys
from typing import Annotated

import typer

from scenarios.otani2017.bag.bag import MASS_KG, BagTrial, perform, trial_figures
from scenarios.replay import Replay
from scenarios.terminal import run_app

app = typer.Typer(add_completion=False)


def trial_line(request: Replay, trial: BagTrial) -> tuple[str, bool, bool]:
    """Fetch a bag once; nothing is written. A line that says how it went, whether it is home, and whether upright."""
    danced, schedule = perform(request, trial, lambda what, share: None)
    own = trial_figures(danced, schedule)
    fell = danced.run.fell_at_s
    outcome = own["outcome"] if fell is None else f"fell at {fell:.1f} s, {danced.run.reason}"
    line = (
        f"{outcome}; centre of mass {1e3 * own['beyond_sole_max_m']:.0f} mm beyond the sole, hand"
        f" {own['palm_force_max_n']:.0f} N, off what was commanded by {100.0 * own['palm_force_error']:.1f} %, slipped"
        f" {schedule.palm.slips} times; other touches: {', '.join(own['foreign_touches']) or 'none'}"
    )
    return line, bool(own["home"]) and fell is None, fell is None


@app.command()
def trials(
    robot: Annotated[str, typer.Option("--robot", help="A robot with palms and hooks.")] = "hrp2",
    rate: Annotated[float, typer.Option(help="Control ticks per second [Hz].")] = 1000.0,
    mass: Annotated[float, typer.Option(help="Of the bag [kg].")] = MASS_KG,
    lower: Annotated[float, typer.Option(help="By which the table is lower than told [m].")] = 0.0,
    palm_friction: Annotated[float | None, typer.Option(help="Of the table under the palm.")] = None,
    first: Annotated[int, typer.Option(help="The first seed.")] = 1,
    seeds: Annotated[int, typer.Option(help="Number of places of the bag, 3 mm and 2 degrees off.")] = 5,
) -> None:
    """Fetch the bag from several places, a line each."""
    home = upright = 0
    for seed in range(first, first + seeds):
        line, is_home, stands = trial_line(Replay("bag", robot, rate=rate), BagTrial(mass, seed, lower, palm_friction))
        home, upright = home + is_home, upright + stands
        print(f"seed {seed}: {line}", flush=True)
    print(f"{home} of {seeds} home, {upright} of {seeds} upright")


def main() -> int:
    """Run the command line; returns the exit code."""
    return run_app(app)


if __name__ == "__main__":
    sys.exit(main())
