"""What `sot list` lists."""

from collections.abc import Iterator
from enum import StrEnum

import tasks
from scenarios.inputs import clips
from scenarios.replay import SOLVERS
from scenarios.robots.summary import robot_summary
from scenarios.studies import SCENARIOS
from sot.control import Task
from sot.exchange.registry import FORMATS
from sot.robots.robot import robot_names


class Kind(StrEnum):
    """What there is to choose from."""

    CLIPS = "clips"
    FORMATS = "formats"
    ROBOTS = "robots"
    SCENARIOS = "scenarios"
    SOLVERS = "solvers"
    TASKS = "tasks"


def list_rows(kind: Kind) -> Iterator[tuple[str, ...]]:
    """A row for each thing of a kind: its name, and what a reader should know of it."""
    match kind:
        case Kind.CLIPS:
            for clip in clips.named_clips():
                yield clip.name, f"{clip.seconds:.1f} s", clip.what, f"{clip.source}, {clip.licence}"
        case Kind.FORMATS:
            for name, one in FORMATS.items():
                ways = "exported, read" if one.write and one.read else "exported" if one.write else "read"
                yield name, ways, f"{one.rate:g} a second" if one.write else "", one.words
        case Kind.ROBOTS:
            for name in robot_names():
                robot = robot_summary(name)
                figures = f"{robot.joints} joints, {robot.mass:.1f} kg, {robot.height:.2f} m"
                yield name, robot.label, figures, robot.origin and f"fetched once: {robot.origin}"
        case Kind.SCENARIOS:
            for name, scenario in SCENARIOS.items():
                yield name, _first_line(scenario)
        case Kind.SOLVERS:
            for name, solver in SOLVERS.items():
                yield name, _first_line(solver)
        case Kind.TASKS:
            for name in tasks.__all__:
                if issubclass(getattr(tasks, name), Task):
                    yield name, _first_line(getattr(tasks, name))


def _first_line(thing: object) -> str:
    return (thing.__doc__ or "").strip().splitlines()[0]
