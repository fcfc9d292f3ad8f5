"""What the command line may say about a robot on compliant feet."""

from pathlib import Path
from typing import Annotated

import typer

from scenarios.kimoh2013.damping.damping import CASES, STUDIES, DampingOptions
from sot.errors import InputError
from sot.servo.pole_placement import FORMS

NAME = "damping"
"""The scenario that takes these options."""
TAKEN = {
    "identify": ("--case",),
    "push": ("--case", "--damping-ratio", "--form", "--identified", "--seeds"),
    "dance": ("--damping-ratio", "--identified"),
    "steps": ("--damping-ratio", "--identified"),
    "gains": (),
}
"""Options of each study."""

Case = Annotated[
    list[str] | None, typer.Option("--case", help="For damping: xz-double, yz-double, … ; all four by default.")
]
DampingRatio = Annotated[
    float | None,
    typer.Option(
        help="For damping push, dance and steps: asked of the damping controller; 0.3, 0.5 and 0.72 in turn, or 0.72."
    ),
]
Form = Annotated[str | None, typer.Option(help="For damping push: filtered, or paper: Kim & Oh's own.")]
IdentifiedFile = Annotated[
    Path | None,
    typer.Option("--identified", help="For damping push, dance and steps: pendulum.toml of damping identify."),
]
Seeds = Annotated[int | None, typer.Option(help="For damping push: pushes of each kind; 5 by default.")]


def damping_options(
    scenario: str,
    study: str | None,
    case: list[str] | None,
    damping_ratio: float | None,
    form: str | None,
    identified: Path | None,
    seeds: int | None,
) -> DampingOptions | None:
    """What is to be identified or pushed; None for another scenario.

    Raises:
        InputError: an option that this scenario or study does not take, or a value that makes no sense.
    """
    own = {
        **{"--case": case or None, "--damping-ratio": damping_ratio, "--form": form},
        **{"--identified": identified, "--seeds": seeds},
    }
    given = [name for name, value in own.items() if value is not None]
    if scenario != NAME:
        if given:
            raise InputError(f"{scenario} takes no {given[0]}: only {NAME} does")
        return None
    if study not in STUDIES:
        raise InputError(f"{NAME}: say which study, {' or '.join(STUDIES)}, not '{study or ''}'")
    if strange := [name for name in given if name not in TAKEN[study]]:
        raise InputError(f"{NAME} {study} takes no {strange[0]}")
    if form is not None and form not in FORMS:
        raise InputError(f"--form {form}: choose one of {', '.join(FORMS)}")
    if damping_ratio is not None and not 0.0 < damping_ratio <= 1.0:
        raise InputError(f"--damping-ratio {damping_ratio:g}: give more than 0, and 1 at most")
    if seeds is not None and seeds < 1:
        raise InputError(f"--seeds {seeds}: give 1 or more")
    return DampingOptions(
        study,
        _cases(case) if case else CASES,
        damping_ratio,
        form or DampingOptions.form,
        identified,
        seeds or DampingOptions.seeds,
    )


def _cases(names: list[str]) -> tuple[tuple[str, str], ...]:
    known = {f"{plane}-{support}": (plane, support) for plane, support in CASES}
    if wrong := [name for name in names if name not in known]:
        raise InputError(f"--case {wrong[0]}: choose of {', '.join(known)}")
    return tuple(known[name] for name in known if name in names)
