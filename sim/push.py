"""Pushes: forces on a robot's bodies, at a time and for a while."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import atan2, cos, hypot, inf, isfinite, sin

import mujoco
import numpy as np

from sot.errors import InputError
from sot.robots.robot import Robot


@dataclass(frozen=True)
class Push:
    """A force on a body for a while, at the centre of mass of the body.

    Attributes:
        t: when it begins [s].
        force: (3,), world axes [N].
        duration: how long it lasts [s].
        body: the operational point of the robot whose body is pushed.

    Raises:
        InputError: numbers that make no push.
    """

    t: float
    force: tuple[float, float, float]
    duration: float = 0.1
    body: str = "chest"

    def __post_init__(self) -> None:
        if not (0.0 <= self.t < inf and 0.0 < self.duration < inf and all(map(isfinite, self.force))):
            raise InputError(f"push at t={self.t:g}: t must not be negative, duration positive, force finite")

    @classmethod
    def horizontal(cls, t: float, impulse: float, direction: float) -> "Push":
        """Push of an impulse [N s] whose direction is an angle about z from x [rad]."""
        push = cls(t, (0.0, 0.0, 0.0))
        force = impulse / push.duration
        return replace(push, force=(force * cos(direction), force * sin(direction), 0.0))

    @property
    def direction(self) -> float:
        """Angle of its force about z, from x [rad]."""
        return atan2(self.force[1], self.force[0])

    @property
    def end(self) -> float:
        """When it ends [s]."""
        return self.t + self.duration

    @property
    def impulse(self) -> float:
        """Force times duration [N s]."""
        return hypot(*self.force) * self.duration

    def is_acting(self, t: float) -> bool:
        """Whether it acts in the physics step that begins at a time [s]."""
        return self.t - 1e-9 <= t < self.end - 1e-9


class Pusher:
    """Applies pushes to the bodies of a world as time goes on; bodies that no push names are left alone.

    Args:
        model, data: MuJoCo's.
        robot: whose operational points the pushes name.
        pushes: in any order; those that overlap add up.

    Raises:
        InputError: the robot has no such point.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, robot: Robot, pushes: Sequence[Push]):
        self._data = data
        self._pushes = [(push, np.array(push.force), _body_of_point(model, robot, push.body)) for push in pushes]
        self._bodies = sorted({body for _, _, body in self._pushes})

    def __call__(self) -> None:
        """Set the forces for the physics step that comes."""
        if not self._bodies:
            return
        self._data.xfrc_applied[self._bodies] = 0.0
        for push, force, body in self._pushes:
            if push.is_acting(self._data.time):
                self._data.xfrc_applied[body, :3] += force


def _body_of_point(model: mujoco.MjModel, robot: Robot, point: str) -> int:
    """MuJoCo's body that carries an operational point: the one that the point's joint moves."""
    joint = robot.model.frames[robot.point(point)].parentJoint
    name = robot.model.names[joint]
    return int(model.joint(name).bodyid[0]) if name in robot.joints else int(model.jnt_bodyid[0])
