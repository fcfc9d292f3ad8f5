"""What a planned motion holds or pushes: arms in given postures, and a mass and a force that the balance counts."""

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.control.tick import Tick
from sot.motion.balance.centroidal import Centroidal
from sot.motion.body.spline import Spline
from sot.robots.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeldLoad:
    """A mass that goes with a body of the robot, and the joints that hold it, at T knots.

    Attributes:
        joints: numbers of the joints whose angles are given (k,).
        angles: of these joints (T, k) [rad].
        mass: of the load, as far as the robot carries it (T,) [kg].
        point: the robot's operational point that the load goes with.
        place: its centre of mass in the axes of that point (T, 3) [m].
        force: level force on the robot that acts there (T, 3), world axes [N]; none unless given.
        lowered: by how much the centre of mass is lower to hold it (T,) [m]; not at all unless given.
        pitch: of the waist to hold it, forward (T,) [rad]; upright unless given.
    """

    joints: Array
    angles: Array
    mass: Array
    point: str
    place: Array
    force: Array = field(default_factory=lambda: np.zeros((1, 3)))
    lowered: Array = field(default_factory=lambda: np.zeros(1))
    pitch: Array = field(default_factory=lambda: np.zeros(1))

    def com_shift(self, height: float, weight: float) -> Array:
        """Of the centre of mass from the middle of the pressure, for the force at a height, (T, 2) or (1, 2) [m]."""
        shift: Array = -height / weight * self.force[:, :2]
        return shift

    def combined_com(self, tick: Tick, k: int) -> tuple[Array, Array]:
        """Centre of mass (3,) of the robot and the load at a knot, and its Jacobian (3, nv); of the load, its place in
        the point's axes stays."""
        frame, mass = tick.frame(self.point), self.mass[k]
        arm = frame.rotation @ self.place[k]
        share = mass / (mass + tick.robot.mass)
        J = frame.jacobian[:3] - pin.skew(arm) @ frame.jacobian[3:]
        return (
            (1.0 - share) * tick.com + share * (frame.position + arm),
            (1.0 - share) * tick.com_jacobian + share * J,
        )

    def combined(self, robot: Robot, state: Centroidal, q: Array, period: float, times: Array) -> Centroidal:
        """Centroidal quantities of the robot and the load at times (n,) [s].

        The load's own turning is left out: it is a point mass. The moment of its force about the point of the floor
        below it is taken from the rate of angular momentum: so `Centroidal.zmp` is the middle of the feet's pressure.

        Args:
            robot: who holds it.
            state: of the robot alone, at the knots.
            q: its configurations at the knots (T, nq).
            period: between the knots [s].
            times: at which the quantities are wanted.
        """
        data, frame = robot.model.createData(), robot.point(self.point)
        at = np.empty((len(q), 3))
        for k, row in enumerate(q):
            pin.framesForwardKinematics(robot.model, data, row)
            at[k] = data.oMf[frame].act(self.place[k])
        m, own, load = robot.mass, robot.mass * state.com, self.mass[:, None]
        com = Spline.through((own + load * at) / (m + load), period)
        path, body = Spline.through(at, period), Spline.through(state.com, period)
        spin = state.momentum[:, 3:].copy()
        for mass, part in ((np.full((len(q), 1), m), body), (load, path)):
            spin += mass * np.cross(part.knots - com.knots, part.velocities - com.velocities)
        turning, total = Spline.through(spin, period), m + float(self.mass.max())
        momentum = np.hstack([total * com(times, 1), turning(times)])
        # What the force turns the body by about the floor below, the floor need not.
        lever = np.column_stack([np.zeros((len(at), 2)), at[:, 2]])
        moment = Spline.through(np.cross(lever, np.broadcast_to(self.force, at.shape)), period)
        rate = np.hstack([total * com(times, 2), turning(times, 1) - moment(times)])
        return Centroidal(com(times), momentum, rate, total)
