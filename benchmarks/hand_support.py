"""How much longer a control tick takes while a hand stands on a table beside both feet, and how long a region takes.

    python benchmarks/hand_support.py [--ticks 1500] [--json]

The same robot sways on both feet with its right palm just above a table, and with the palm on it: one contact more, and
balance keeps to the static region of all three. The two take turns, as in `held_box.py`. Beside that the static region
of each set of contacts of a bag that is fetched is computed some times over.
"""

import argparse
import json
from time import thread_time
from typing import Any

import numpy as np
import pinocchio as pin
from held_box import PERIOD, SWAY_M, SWAY_RATE, Integrated, interleaved, show
from rich.console import Console

from sot.control import Contact, Stack, Tick
from sot.gravity import GRAVITY
from sot.robots import Robot, System, Thing
from sot.static_region import Patch, static_region
from tasks import Balance, JointBounds, LeastForces, OperationalPoint, Posture, SelfCollision, TorqueBounds

Array = np.ndarray
ARM_ANGLES = {"RARM0": 0.0, "RARM1": 0.0, "RARM3": -0.5 * np.pi, "RARM4": 0.5 * np.pi, "RARM6": 0.0}
"""Angles at which the forearm is level and the palm faces down [rad]."""
PALM_MOST = 250.0  # N
REPEATS = 15


class Stander(Integrated):
    """A robot that sways in place, with or without its palm on a table, tick by tick.

    Args:
        robot: HRP-2-like.
        supports: Whether the palm is on the table.
    """

    def __init__(self, robot: Robot, supports: bool) -> None:
        q = robot.rest.copy()
        for name, angle in ARM_ANGLES.items():
            q[7 + robot.joints.index(name)] = angle
        alone = Tick(robot, PERIOD).update(0.0, q, np.zeros(robot.nv))
        palm = robot.surface("right_palm")
        x, y, height = alone.surface_axes(palm).translation
        table = Thing.load("table", placement=(x + 0.25, y, 0.0), size=(0.6, 0.8, height - (0.0 if supports else 0.03)))
        self.system = system = System(robot, [table])
        self.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
        hand = Contact(palm, table.surface("top"), axes="xyzRP", least=15.0, most=PALM_MOST, reserve=3.0)
        hand.mode = "fixed" if supports else "off"
        self.contacts.append(hand)
        start = alone.com.copy()

        def sway(t: float) -> tuple[Array, Array, Array, Array]:
            place = start + np.array([SWAY_M * np.sin(SWAY_RATE * t), 0.0, 0.0])
            return place, np.zeros(3), np.zeros(3), place[:2]

        waist = alone.frame("waist")
        levels = {
            "balance": [Balance(sway, axes="xy")],
            "motion": [
                OperationalPoint(system, "waist", pin.SE3(waist.rotation, waist.position), kp=60.0, weight=10.0),
                Posture(robot, q[7:], kp=20.0, weight=0.3),
            ],
            "forces": [LeastForces()],
        }
        stack = Stack(self.contacts, [TorqueBounds(robot), JointBounds(robot), SelfCollision(system)], levels)
        super().__init__(system, stack, q)

    def patches(self) -> dict[str, Patch]:
        """The contacts as patches that carry, by the first surface's name."""
        found = {}
        for contact in self.contacts:
            frame = self._controller.tick.frame(contact.point)
            points = frame.position + contact.vertices @ frame.rotation.T
            found[contact.surface.name] = Patch(points, np.eye(3), contact.friction, contact.most)
        return found


def region_seconds(stander: Stander) -> dict[str, float]:
    """Median CPU time of the static region of sets of contacts [s]."""
    patches, weight = stander.patches(), stander.system.robot.mass * GRAVITY
    left, right = stander.system.robot.feet
    seconds = {}
    for names in ((left, right), (left, right, "right_palm"), (right, "right_palm")):
        times = []
        for _ in range(REPEATS):
            begun = thread_time()
            static_region([patches[name] for name in names], weight)
            times.append(thread_time() - begun)
        seconds[" + ".join(names)] = float(np.median(times))
    return seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ticks", type=int, default=1500, help="of each")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    robot = Robot.load("hrp2")
    standers = {"feet": Stander(robot, False), "hand": Stander(robot, True)}
    figures: dict[str, Any] = interleaved(standers, options.ticks)
    figures["region_s"] = region_seconds(standers["hand"])
    if options.json:
        print(json.dumps(figures, indent=2))
        return
    console = Console()
    show(figures, console, ("both feet", "and a hand"))
    for names, seconds in figures["region_s"].items():
        console.print(f"static region of {names}: {1e3 * seconds:.0f} ms", highlight=False)


if __name__ == "__main__":
    main()
