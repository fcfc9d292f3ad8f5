"""How HumanoidBench's scenes are scaled to a robot."""

from sot.robots.robot import Robot
from sot.robots.size import standing_height

BENCHMARK_HEIGHT_M = 1.8
"""Height of the robot for which the benchmark's scenes are made [m]."""


def scene_scale(robot: Robot) -> float:
    """Factor of the lengths of a scene; masses and springs stay as they are."""
    return standing_height(robot) / BENCHMARK_HEIGHT_M
