"""What the command line may say about HumanoidBench's scenes."""

from scenarios.humanoidbench.humanoidbench import SCENES, BenchTrial
from sot.errors import InputError

NAME = "humanoidbench"
"""The scenario that takes these options."""


def bench_options(scenario: str, study: str | None, seed: int | None) -> BenchTrial | None:
    """The scene that is to be run; None for another scenario.

    Raises:
        InputError: No such scene, or a seed that is none.
    """
    if scenario != NAME:
        return None
    if study not in SCENES:
        raise InputError(f"{NAME}: say which scene, {' or '.join(SCENES)}, not '{study or ''}'")
    if seed is not None and seed < 0:
        raise InputError(f"--seed {seed}: give 0 or more")
    return BenchTrial(study, BenchTrial.seed if seed is None else seed)
