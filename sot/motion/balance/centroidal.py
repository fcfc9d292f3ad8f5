"""Centroidal quantities of a whole-body motion: centre of mass, momentum and zero moment point."""

from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.motion.body.coordinates import rate_matrix, to_configuration, to_rotation
from sot.robots.robot import Robot

Array = NDArray[np.float64]

MIN_WEIGHT_SHARE = 0.3  # of the weight, on the floor: with less, on the way into a jump, the ZMP means nothing


@dataclass(frozen=True)
class Centroidal:
    """Centroidal quantities over time, in world axes.

    Attributes:
        com: (T, 3) centre of mass [m].
        momentum: (T, 6) linear over angular about the centre of mass [N s, N m s].
        rate: (T, 6) its time derivative [N, N m].
        mass: of the robot [kg].
    """

    com: Array
    momentum: Array
    rate: Array
    mass: float

    @staticmethod
    def along(robot: Robot, q: Array, v: Array, a: Array) -> "Centroidal":
        """The centroidal quantities of a motion q (T, nq), v (T, nv), a (T, nv) in Pinocchio's conventions."""
        model, data = robot.model, robot.model.createData()
        com, momentum, rate = np.empty((len(q), 3)), np.empty((len(q), 6)), np.empty((len(q), 6))
        for k in range(len(q)):
            rate[k] = pin.computeCentroidalMomentumTimeVariation(model, data, q[k], v[k], a[k]).vector
            momentum[k] = data.hg.vector
            com[k] = data.com[0]
        return Centroidal(com, momentum, rate, robot.mass)

    def __getitem__(self, rows: slice) -> "Centroidal":
        """The quantities at some of the times."""
        return Centroidal(self.com[rows], self.momentum[rows], self.rate[rows], self.mass)

    def __setitem__(self, rows: slice, other: "Centroidal") -> None:
        self.com[rows], self.momentum[rows], self.rate[rows] = other.com, other.momentum, other.rate

    @property
    def velocity(self) -> Array:
        """The velocity of the centre of mass (T, 3) [m/s]."""
        return self.momentum[:, :3] / self.mass

    @property
    def acceleration(self) -> Array:
        """The acceleration of the centre of mass (T, 3) [m/s²]."""
        return self.rate[:, :3] / self.mass

    def toward(self, other: "Centroidal", share: float) -> "Centroidal":
        """The quantities a share of the way toward others."""

        def mixed(mine: Array, theirs: Array) -> Array:
            return mine + share * (theirs - mine)

        com, momentum = mixed(self.com, other.com), mixed(self.momentum, other.momentum)
        return Centroidal(com, momentum, mixed(self.rate, other.rate), self.mass)

    def above(self, ground: Array) -> "Centroidal":
        """The quantities with a centre of mass whose height counts from that of the ground (T,) [m]."""
        return replace(self, com=self.com - np.outer(ground, [0.0, 0.0, 1.0]))

    def pendulum(self) -> tuple[Array, Array]:
        """h (T,) and offset (T, 2) of the ZMP on z = 0, z = c − h c̈ + offset in the plane:
        h = c_z / (g + c̈_z), offset = (−L̇_y, L̇_x) / (m (g + c̈_z))."""
        gravity = np.maximum(GRAVITY + self.acceleration[:, 2], MIN_WEIGHT_SHARE * GRAVITY)
        turning = np.column_stack([-self.rate[:, 4], self.rate[:, 3]])
        return self.com[:, 2] / gravity, turning / (self.mass * gravity)[:, None]

    def zmp(self) -> Array:
        """The zero moment point on z = 0, (T, 2) [m]."""
        height, offset = self.pendulum()
        return self.com[:, :2] - height[:, None] * self.acceleration[:, :2] + offset


def momentum_maps(robot: Robot, y: Array) -> Array:
    """Maps (T, 6, nv) from the rates of coordinates y (T, nv) (see coordinates) to linear and angular momentum."""
    model, data = robot.model, robot.model.createData()
    maps = np.array([pin.computeCentroidalMap(model, data, q) for q in to_configuration(y)])
    maps[:, :, :3] = maps[:, :, :3] @ to_rotation(y[:, 3:6]).transpose(0, 2, 1)
    maps[:, :, 3:6] = maps[:, :, 3:6] @ rate_matrix(y[:, 3:6])
    return maps
