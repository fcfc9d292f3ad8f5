"""What a list says of a robot, without fetching its model."""

from dataclasses import dataclass

from sot.robots.robot import MODELS, Robot
from sot.robots.robot_file import RobotFile
from sot.robots.size import standing_height


@dataclass(frozen=True)
class Summary:
    """A robot in a list.

    Attributes:
        label: what a reader should call it.
        joints: how many it has.
        mass: [kg].
        height: on straight legs [m].
        origin: whose model it is, under which licence, and the package it is fetched with; empty if it is shipped.
    """

    label: str
    joints: int
    mass: float
    height: float
    origin: str


def robot_summary(name: str) -> Summary:
    """What is known of a robot that has a name: of a fetched one as its file lists it, of others as they are.

    Raises:
        InputError: its file is incomplete.
    """
    file = RobotFile(MODELS / f"{name}.toml")
    if "package" not in file.content:
        robot = Robot.load(name)
        return Summary(robot.label, robot.na, robot.mass, standing_height(robot), "")
    joints, mass, height = (file.get(f"listed.{key}", int, float) for key in ("joints", "mass", "height"))
    source, licence, package, version = (
        file.get(f"package.{key}", str) for key in ("source", "licence", "name", "version")
    )
    origin = f"{source}; {licence}; in {package} {version}"
    return Summary(file.get("label", str), joints, mass, height, origin)
