"""`sot run humanoidbench push`: a light box on a table is slid to another place."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from scenarios.humanoidbench.size import scene_scale
from scenarios.humanoidbench.stack import led_hands_stack
from scenarios.inputs.stack_file import Composition
from scenarios.replay import Dance, ProgressCallback, Replay, run_motion
from sim.reporting.objects import object_figures
from sot.behaviours.stepping import SteppingSchedule
from sot.control.stack import Stack
from sot.motion.carrying.slide import SlidePlan, slide
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.robots.things.thing import Thing

Array = np.ndarray

BOX, TABLE = "box", "table"
"""Names of the things."""
BOX_M, MASS_KG = 0.2, 0.3
"""Side of the benchmark's box [m], and its mass [kg]."""
START_M = (0.7, 0.0, 1.0)
"""Where its middle is at the start [m]."""
AHEAD_M, ASIDE_M = (0.7, 1.0), (-0.5, 0.5)
"""Ranges of its destination [m]."""
TABLE_M, TABLE_AHEAD_M = (1.0, 2.0, 0.9), 0.9
"""Size of the table and where its middle is [m]."""
REACHED_M = 0.05
"""Distance of the box's middle from its destination within which it is there [m]."""
STEP_UP_M = 0.12
"""How far the robot steps up to the table, in the benchmark's size [m]."""


@dataclass(frozen=True)
class PushScene:
    """Where the box stands and where it is to be, its middle, from the robot's place at the start (3,) [m]."""

    box: Array
    destination: Array
    scale: float

    @staticmethod
    def of(robot: Robot, seed: int) -> "PushScene":
        """The scene of a seed: the destination is drawn."""
        scale, random = scene_scale(robot), np.random.default_rng(seed)
        goal = [random.uniform(*AHEAD_M), random.uniform(*ASIDE_M), START_M[2]]
        return PushScene(scale * np.array(START_M), scale * np.array(goal), scale)

    def plan(self, robot: Robot, rate: float) -> SlidePlan:
        """The motion that slides the box.

        Raises:
            InputError: Arms or legs do not reach.
        """
        side = self.scale * BOX_M
        return slide(robot, (side, side, side), self.box, self.destination, self.scale * STEP_UP_M, rate)

    def table(self) -> Thing:
        """The table, as a block."""
        size = [self.scale * side for side in TABLE_M]
        return Thing.load("table", TABLE, (self.scale * TABLE_AHEAD_M, 0.0, 0.0), size=size)

    def thing(self) -> Thing:
        """The box."""
        return Thing.load("box", BOX, self.box.tolist(), mass=MASS_KG, size=[self.scale * BOX_M] * 3)


def push_stack(system: System, plan: SlidePlan) -> Stack:
    """The stack of a robot that steps while its hand is led in the world: it keeps clear of the table, and knows of no
    box."""
    return led_hands_stack(system, plan.motion, {plan.hand: plan.path})


def perform(request: Replay, seed: int, tell: ProgressCallback) -> tuple[Dance, PushScene]:
    """Plan and run; nothing is written."""
    robot = Robot.load(request.robot)
    tell("planning", None)
    scene = PushScene.of(robot, seed)
    plan, table = scene.plan(robot, request.rate), scene.table()
    system = System(robot, [table])

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(push_stack(system, plan), SteppingSchedule(robot, motion.phases))

    danced = run_motion(request, compose, plan.motion, None, tell, system=system, things=[table, scene.thing()])
    return danced, scene


def figures(danced: Dance, scene: PushScene) -> dict[str, Any]:
    """What became of the box."""
    assert danced.system is not None
    found = object_figures(danced.run.log.trimmed(), danced.system)
    off = float(np.linalg.norm(np.array(found[BOX]["end_m"]) - scene.destination))
    own = {
        "destination_m": scene.destination.tolist(),
        "pushed_m": float(np.linalg.norm(np.array(found[BOX]["end_m"]) - scene.box)),
        "off_destination_m": off,
        "reached": off < REACHED_M and danced.run.fell_at_s is None,
    }
    return {"objects": found, "humanoidbench": own}


def scene_run(request: Replay, seed: int, tell: ProgressCallback) -> tuple[Dance, dict[str, Any]]:
    """Plan and run the scene of a seed: the run, and its figures."""
    done, scene = perform(request, seed, tell)
    return done, figures(done, scene)


def sentence(own: dict[str, Any]) -> str:
    """What became of it, for a reader."""
    off = 1e3 * own["off_destination_m"]
    return f"the box slid by {own['pushed_m']:.2f} m, its middle {off:.0f} mm off its destination"
