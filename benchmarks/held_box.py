"""How much longer a control tick takes while two palms hold a box than without the box.

    python benchmarks/held_box.py [--ticks 1500] [--robot hrp2] [--json]

The same robot stands in the same posture and sways, once with its hands led by tasks, and once with a box between its
palms: six more velocities, two more contacts, distances of the box to all else. The two take turns, so that a machine
that is busy slows both down alike. There is no physics: the state follows the accelerations that are commanded.
"""

import argparse
import json
from collections.abc import Mapping
from time import thread_time
from typing import Any

import numpy as np
import pinocchio as pin
from rich.console import Console
from rich.table import Table

from solvers import Cascade
from sot.control import Contact, Controller, Stack, Tick
from sot.control.controller import Command
from sot.robots import Robot, System, Thing
from tasks import (
    CenterOfMass,
    JointBounds,
    LeastForces,
    OperationalPoint,
    Posture,
    SelfCollision,
    TorqueBounds,
)

Array = np.ndarray
PERIOD = 0.001  # s
TURN_TICKS = 25  # ticks of one before the other's turn
WARM_UP_TURNS = 4  # not counted
ARM_ANGLES = {f"{side}ARM{k}": angle for side in "RL" for k, angle in ((0, 0.0), (3, -1.5))}  # rad: forearms level
SWAY_M, SWAY_RATE = 0.003, 3.0  # rad/s
BOX_SIDES = (0.25, 0.2)  # m, along x and z; the palms' distance is the third
PHASES = ("model", "assemble", "solve")


class Integrated:
    """A robot that does exactly what it is told, tick by tick."""

    def __init__(self, system: System, stack: Stack, q: Array) -> None:
        self._model, self._q, self._v, self._count = system.model, q, np.zeros(system.nv), 0
        self._controller = Controller(system, stack, Cascade(), PERIOD)

    def step(self) -> Command:
        """One tick; the state follows the accelerations it commands."""
        command = self._controller(PERIOD * self._count, self._q, self._v)
        self._v = self._v + PERIOD * command.acceleration
        self._q = pin.integrate(self._model, self._q, PERIOD * self._v)
        self._count += 1
        return command


class Stander(Integrated):
    """A robot that sways in place, with or without a box between its palms, tick by tick.

    Args:
        robot: One that has palms.
        holds: Whether it holds the box.
    """

    def __init__(self, robot: Robot, holds: bool) -> None:
        q = robot.rest.copy()
        for name, angle in ARM_ANGLES.items():
            q[7 + robot.joints.index(name)] = angle
        alone = Tick(robot, PERIOD).update(0.0, q, np.zeros(robot.nv))
        left, right = (alone.surface_axes(robot.surface(f"{side}_palm")).translation for side in ("left", "right"))
        size = (BOX_SIDES[0], float(left[1] - right[1]), BOX_SIDES[1])
        box = Thing.load("box", placement=pin.SE3(np.eye(3), 0.5 * (left + right)), size=size)
        self.system = system = System(robot, [box] if holds else [])
        contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
        if holds:
            contacts += [
                Contact(
                    robot.surface(f"{side}_palm"), box.surface(side), least=15.0, most=200.0, wish=50.0, stiffness=0.0
                )
                for side in ("left", "right")
            ]
        hard = [TorqueBounds(robot), JointBounds(robot), SelfCollision(system)]
        tick, placed = Tick(system, PERIOD), system.rest.copy()
        placed[: robot.nq] = q
        tick.carried = carried = ("box",) if holds else ()
        start = tick.update(0.0, placed, np.zeros(system.nv)).com.copy()
        led = ("waist", "box") if holds else ("waist", *robot.hands)
        frames = {point: tick.frame(point) for point in led}
        motion = [
            OperationalPoint(system, point, pin.SE3(frame.rotation, frame.position), kp=60.0, weight=10.0)
            for point, frame in frames.items()
        ]

        def sway(t: float) -> tuple[Array, Array, Array]:
            return start + np.array([SWAY_M * np.sin(SWAY_RATE * t), 0.0, 0.0]), np.zeros(3), np.zeros(3)

        levels = {
            "com": [CenterOfMass(sway, axes="xy", kp=60.0)],
            "motion": [Posture(robot, q[7:], kp=20.0, weight=0.3), *motion],
            "forces": [LeastForces()],
        }
        stack = Stack(contacts, hard, levels)
        stack.carried = list(carried)
        super().__init__(system, stack, placed)


def interleaved(standers: Mapping[str, Integrated], ticks: int) -> dict[str, Any]:
    """Medians of the phases of a tick of each stander, of their sums and of a step's own CPU time [µs].

    They take turns of a few ticks. CPU time does not count what else runs on a machine that is busy.
    """
    times: dict[str, list[tuple[float, float, float]]] = {name: [] for name in standers}
    cpu: dict[str, list[float]] = {name: [] for name in standers}
    for turn in range(WARM_UP_TURNS + -(-ticks // TURN_TICKS)):
        for name, stander in standers.items():
            for _ in range(TURN_TICKS):
                begun = thread_time()
                command = stander.step()
                used = 1e6 * (thread_time() - begun)
                if turn >= WARM_UP_TURNS:
                    times[name].append((command.model_us, command.assemble_us, command.solve_us))
                    cpu[name].append(used)
    medians = {name: np.median(rows, axis=0) for name, rows in times.items()}
    whole = {name: float(np.median(np.sum(rows, axis=1))) for name, rows in times.items()}
    figures: dict[str, Any] = {
        name: {
            **dict(zip(PHASES, medians[name].tolist(), strict=True)),
            "whole": whole[name],
            "cpu": float(np.median(cpu[name])),
        }
        for name in standers
    }
    first, second = standers
    return {"ticks": len(times[second]), "tick_us": figures, "ratio": whole[second] / whole[first]}


def measure(robot: Robot, ticks: int) -> dict[str, Any]:
    """Medians of the phases of a tick without and with the box [µs], and the ratio of their sums."""
    return interleaved({"without": Stander(robot, False), "held": Stander(robot, True)}, ticks)


def show(figures: dict[str, Any], console: Console, names: tuple[str, str]) -> None:
    """Print the figures as a table; `names` are what its two columns of times are called."""
    table = Table("median, µs", *names, "ratio", box=None, padding=(0, 2, 0, 0))
    first, second = figures["tick_us"].values()
    for phase in (*PHASES, "whole", "cpu"):
        row = f"{first[phase]:.0f}", f"{second[phase]:.0f}", f"{second[phase] / first[phase]:.2f}"
        table.add_row({"whole": "tick", "cpu": "CPU time"}.get(phase, phase), *row)
    console.print(table)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ticks", type=int, default=1500, help="of each")
    parser.add_argument("--robot", default="hrp2", help="a robot with palms")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    figures = measure(Robot.load(options.robot), options.ticks)
    print(json.dumps(figures, indent=2)) if options.json else show(figures, Console(), ("without", "with the box held"))


if __name__ == "__main__":
    main()
