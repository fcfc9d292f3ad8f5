"""What the command line may say about the things that are handled."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from scenarios.otani2017.bag.bag import BagTrial
from scenarios.otani2017.carrying.carry import Carrying
from scenarios.otani2017.carrying.cart import Pushing
from scenarios.otani2017.otani import Handling
from scenarios.otani2017.scene import ObjectOptions
from sot.errors import InputError

NAME = "otani"
"""The scenario that takes these options."""
_BOX = ("--mass", "--assumed-mass", "--friction", "--seed")
_DEMONSTRATED = ("--friction", "--without-object", "--events")
TAKEN: dict[str, tuple[str, ...]] = {
    "box": (*_BOX, *_DEMONSTRATED, "--from-plate"),
    "door": (*_DEMONSTRATED, "--stiffness", "--damping", "--assumed-stiffness"),
    "bag": ("--mass", "--seed"),
    "carry": _BOX,
    "cart": (),
}
"""What is handled -> options that it takes."""

Study = Annotated[
    str | None,
    typer.Argument(
        help="For otani: box, door, bag, carry or cart; for humanoidbench: push, package or door; for damping:"
        " identify, push, dance or gains."
    ),
]
Mass = Annotated[
    float | None, typer.Option(help="For otani box, bag and carry: its mass [kg]; 3, 1.5 or 2 by default.")
]
Stiffness = Annotated[float | None, typer.Option(help="For otani door: spring of the hinge [N m/rad]; 0 by default.")]
Damping = Annotated[float | None, typer.Option(help="For otani door: damping of the hinge [N m s/rad].")]
Friction = Annotated[float | None, typer.Option(help="For otani: of things on surfaces; 0.7 by default.")]
AssumedMass = Annotated[
    float | None, typer.Option(help="For otani box and carry: the mass that the controller is told [kg].")
]
AssumedStiffness = Annotated[float | None, typer.Option(help="For otani door: the spring that it is told [N m/rad].")]
WithoutObject = Annotated[bool, typer.Option("--without-object", help="For otani: the controller knows no object.")]
FromPlate = Annotated[bool, typer.Option("--from-plate", help="For otani box: from a low plate, not from a stand.")]
Seed = Annotated[
    int | None,
    typer.Option(
        help="For otani box, bag and carry: it is 3 mm and 2 degrees off; for stairs: treads 3 mm; for"
        " humanoidbench: of its places."
    ),
]
Events = Annotated[Path | None, typer.Option(help="For otani: file (.toml) of contact events, docs/otani-2017.md.")]


def handling_options(
    scenario: str,
    study: str | None,
    mass: float | None,
    stiffness: float | None,
    damping: float | None,
    friction: float | None,
    assumed_mass: float | None,
    assumed_stiffness: float | None,
    without_object: bool,
    from_plate: bool,
    seed: int | None,
    events: Path | None,
) -> Handling | BagTrial | Carrying | Pushing | None:
    """What is to be handled; None for a scenario that handles nothing.

    Raises:
        InputError: An option that this scenario or study does not take, or a value that makes no sense.
    """
    given = {
        "--mass": mass,
        "--stiffness": stiffness,
        "--damping": damping,
        "--friction": friction,
        "--assumed-mass": assumed_mass,
        "--assumed-stiffness": assumed_stiffness,
        "--without-object": without_object or None,
        "--from-plate": from_plate or None,
        "--seed": seed,
        "--events": events,
    }
    named = [name for name, value in given.items() if value is not None]
    if scenario != NAME:
        if named := [name for name in named if name != "--seed"]:  # others take one, too
            raise InputError(f"{scenario} takes no {named[0]}: only {NAME} does")
        return None
    if study is None or study not in TAKEN:
        raise InputError(f"{NAME}: say what is handled, {' or '.join(TAKEN)}, not '{study or ''}'")
    if wrong := [name for name in named if name not in TAKEN[study]]:
        raise InputError(f"{NAME} {study} takes no {wrong[0]}")
    for name, value in given.items():
        least = 0.0 if name in ("--stiffness", "--damping", "--assumed-stiffness") else 1e-3
        if isinstance(value, float) and not least <= value < math.inf:
            raise InputError(f"{name} {value:g}: give a number of {least:g} or more")
    if study == "bag":
        return BagTrial(BagTrial.mass if mass is None else mass, seed)
    if study == "cart":
        return Pushing()
    usual = Carrying().actual.mass if study == "carry" else ObjectOptions.mass
    actual = ObjectOptions(usual if mass is None else mass, friction, stiffness, damping)
    assumed = None
    if assumed_mass is not None or assumed_stiffness is not None:
        assumed = replace(
            actual,
            mass=actual.mass if assumed_mass is None else assumed_mass,
            stiffness=actual.stiffness if assumed_stiffness is None else assumed_stiffness,
        )
    if study == "carry":
        return Carrying(actual, assumed, seed)
    return Handling(study, from_plate, actual, assumed, without_object, seed, events)
