"""Touch: which parts of robot, things and world press on one another, and how."""

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from sim.hardware.soles import sole_bodies
from sim.sensors import ROBOT_BODY
from sot.robots.robot import Robot
from sot.robots.surface import Surface
from sot.robots.things.thing import Thing

Array = np.ndarray


class Touch(NamedTuple):
    """What presses two parts onto each other.

    Attributes:
        normal: Sum of the normal forces [N].
        force: Force of the second part on the first (3,), world [N].
        point: Mean of the contact points weighted by normal force (3,), world [m].
    """

    normal: float
    force: Array
    point: Array


class TouchSensors:
    """Forces between each pair of parts that touch; parts of the robot come first, then things, then what is fixed.

    Parts are the robot's surfaces (the soles, named as their feet, and palms), any other of its bodies by its name,
    things by theirs, the "floor", and what a scene adds by the name of its geom.

    Args:
        model, data: MuJoCo's.
        robot: The robot.
        things: In the world.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, robot: Robot, things: Sequence[Thing]) -> None:
        self._model, self._data, self._robot = model, data, robot
        self._feet = {int(model.body_weldid[body]): foot for foot, body in sole_bodies(model, robot.feet).items()}
        self._things = {thing.name: 1 + k for k, thing in enumerate(things)}
        self._parts = [self._part(geom) for geom in range(model.ngeom)]
        self._names = {name for _, name in self._parts}

    def touches(self) -> dict[tuple[str, str], Touch]:
        """Touch of each pair of parts that do, the robot against itself left out."""
        data, wrench = self._data, np.empty(6)
        found: dict[tuple[str, str], list[Array]] = {}
        frames = data.contact.frame.reshape(-1, 3, 3)
        for k, (one, other) in enumerate(data.contact.geom.tolist()):
            (first_rank, first), (second_rank, second) = self._parts[one], self._parts[other]
            if first == second or not (first_rank or second_rank):
                continue
            mujoco.mj_contactForce(self._model, data, k, wrench)
            # MuJoCo's force is the first geom's on the second.
            key, sign = ((first, second), -1.0) if first_rank < second_rank else ((second, first), 1.0)
            force = sign * wrench[:3] @ frames[k]
            row = np.concatenate([wrench[:1], force, wrench[0] * data.contact.pos[k]])
            found.setdefault(key, []).append(row)
        out = {}
        for key, rows in found.items():
            total = np.sum(rows, axis=0)
            out[key] = Touch(float(total[0]), total[1:4], total[4:] / max(total[0], 1e-9))
        return out

    def part_of(self, surface: Surface) -> str:
        """Name of the part that a surface belongs to."""
        if surface.owner in self._things or surface.point not in self._robot.points:
            return surface.owner
        if surface.name in self._names:
            return surface.name
        return str(self._model.body(self._model.site(surface.point).bodyid[0]).name)

    def _part(self, geom: int) -> tuple[int, str]:
        """Rank and name of the part that a geom belongs to: 0 for the robot, then the things, then the rest."""
        model, name = self._model, self._model.geom(geom).name
        body = int(model.geom_bodyid[geom])
        thing = model.body(body).name.split("/", 1)[0]
        if thing in self._things:
            return self._things[thing], thing
        if model.body_rootid[body] != ROBOT_BODY:
            return 1 + len(self._things), name or model.body(body).name
        own = name if name in self._robot.surfaces else model.body(body).name
        return 0, self._feet.get(int(model.body_weldid[body]), own)
