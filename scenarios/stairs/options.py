"""What the command line may say about the stairs."""

from typing import Annotated

import numpy as np
import typer

from scenarios.stairs.stairs import Stairs
from sot.errors import InputError

NAME = "stairs"
"""The scenario that takes these options."""

Rise = Annotated[
    float | None, typer.Option(help="For stairs: from tread to tread [m]; 0.1 by default, 0 with --slope: a ramp.")
]
Depth = Annotated[float | None, typer.Option(help="For stairs: of a tread [m]; 0.3 by default.")]
Treads = Annotated[int | None, typer.Option(help="For stairs: number of treads up to the highest; 4 by default.")]
Slope = Annotated[
    float | None, typer.Option(help="For stairs: of the treads but the highest, up towards it [deg]; 0 by default.")
]


def stairs_options(
    scenario: str,
    rise: float | None,
    depth: float | None,
    treads: int | None,
    slope: float | None,
    seed: int | None,
) -> Stairs | None:
    """The stairs to be climbed; None for another scenario.

    Raises:
        InputError: an option that this scenario does not take, or a value that makes no sense.
    """
    lengths = {"--rise": rise, "--depth": depth}
    if scenario != NAME:
        if given := [
            name for name, value in {**lengths, "--treads": treads, "--slope": slope}.items() if value is not None
        ]:
            raise InputError(f"{scenario} takes no {given[0]}: only {NAME} does")
        return None
    for name, value in lengths.items():
        if value is not None and not 0.01 <= value < 2.0:
            raise InputError(f"{name} {value:g}: give 0.01 m or more, and less than 2 m")
    if treads is not None and not 1 <= treads <= 50:
        raise InputError(f"--treads {treads}: give 1 to 50")
    if slope is not None and not 0.0 <= slope <= 45.0:
        raise InputError(f"--slope {slope:g}: give 0 to 45 degrees")
    return Stairs(
        (0.0 if slope else Stairs.rise) if rise is None else rise,
        Stairs.depth if depth is None else depth,
        Stairs.treads if treads is None else treads,
        float(np.radians(slope or 0.0)),
        seed,
    )
