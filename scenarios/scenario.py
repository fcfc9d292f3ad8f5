"""A run of a user's own, as a file for `sot run` returns it."""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.own_scene import Scene
from solvers.rows import Solver
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.motion.edit import Edit
from sot.motion.trajectory import Motion


@dataclass(frozen=True)
class Scenario:
    """A motion, what the robot is asked for, and the world around it. `scenario(robot, rate)` in a file returns one.

    Attributes:
        motion: the reference, of the robot and at the rate given; it says how long the run is.
        stack: what the robot is asked for.
        schedule: how that changes over time.
        edits: of the motion, Ramos IV-B.
        scene: what is in the world besides the robot and the floor, see `sim.World`.
        solver: unless given, the one that `--solver` names.
    """

    motion: Motion
    stack: Stack
    schedule: Schedule | None = None
    edits: Sequence[Edit] = ()
    scene: Scene | None = None
    solver: Solver | None = None
