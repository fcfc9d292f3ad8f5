"""All that will not work of a robot file, found before it dances."""

from pathlib import Path

from scenarios.robots.clearance import clearance_findings
from scenarios.robots.findings import Finding, Severity
from scenarios.robots.parts import part_findings, remark_findings
from scenarios.robots.soles import at_rest, sole_findings
from scenarios.robots.standing import standing_findings
from sot.errors import InputError
from sot.robots.robot import Robot


def check(file: str | Path) -> list[Finding]:
    """What is found of a robot file, or of a robot's name; a file that cannot be loaded is the one finding then."""
    try:
        robot = Robot.load(file)
        posed = at_rest(robot)
    except InputError as error:
        return [Finding(Severity.STOPS, str(error), str(file), "correct the file")]
    return [
        *part_findings(robot),
        *sole_findings(robot, posed),
        *clearance_findings(robot, posed),
        *standing_findings(robot),
        *remark_findings(robot),
    ]
