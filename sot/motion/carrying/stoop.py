"""Postures of a robot that stoops to where its hands are to be: feet planted, the centre of mass above them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot

Array = np.ndarray

NEWTON_STEPS = 60  # of inverse kinematics, at most
MAX_STEP = 0.2  # m and rad, of a joint or the waist in a Newton step
HOMEWARD_SHARE = 0.05  # of the way to the posture before in a step, within the null space of all that is asked
DAMPING = 1e-6  # beside squared lengths [m²]
TOLERANCE, ROUNDING = 5e-3, 1e-8  # m and rad


@dataclass(frozen=True)
class Stoop:
    """What a posture asks of the trunk.

    Attributes:
        lowered: by how much the centre of mass is lower than at rest [m].
        pitch: of the waist, forward [rad].
    """

    lowered: float = 0.0
    pitch: float = 0.0

    def turn(self) -> Array:
        """Axes of the waist (3, 3), of a robot that faces along x."""
        pitched: Array = pin.utils.rotate("y", self.pitch)
        return pitched


class StoopedArms:
    """Inverse kinematics of a whole robot that stands as at rest and stoops; its trunk and head are straight.

    Args:
        robot: who stoops.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot, self._tick = robot, Tick(robot)
        self._tick.update(0.0, robot.rest, np.zeros(robot.nv))
        self.com = self._tick.com.copy()
        self._feet = {foot: self._place(foot) for foot in robot.feet}
        self._free = np.ones(robot.nv, dtype=bool)
        limbs = np.concatenate([robot.joint_numbers("legs"), robot.joint_numbers("arms")])
        self._free[6 + np.setdiff1d(np.arange(robot.na), limbs)] = False

    def reaching(
        self,
        hands: Mapping[str, pin.SE3],
        stoop: Stoop,
        start: Array | None = None,
    ) -> Array:
        """Configuration (nq,) of a robot at the origin whose hands are where they should be.

        Args:
            hands: hand -> place of its frame in the world.
            stoop: how it stoops.
            start: configuration (nq,) near which it is; at rest unless given.

        Raises:
            InputError: the hands do not reach.
        """
        robot = self._robot
        near = robot.rest if start is None else start
        q, wrong = near.copy(), np.inf
        for _ in range(NEWTON_STEPS):
            self._tick.update(0.0, q, np.zeros(robot.nv))
            J, error = self._rows(hands, stoop)
            wrong = float(np.abs(error).max())
            if wrong < ROUNDING:
                break
            home = np.concatenate([np.zeros(6), HOMEWARD_SHARE * (near[7:] - q[7:])])
            q = pin.integrate(robot.model, q, self._step(q, J, error, home))
        if wrong > TOLERANCE:
            raise InputError(f"{robot.label} does not reach where its hands should be, by {wrong:.2f} m or rad")
        return q

    def _rows(self, hands: Mapping[str, pin.SE3], stoop: Stoop) -> tuple[Array, Array]:
        """Jacobian and error of all that is asked."""
        waist = self._tick.frame("waist")
        rows = [self._tick.com_jacobian, waist.jacobian[3:]]
        errors = [
            self.com - [0.0, 0.0, stoop.lowered] - self._tick.com,
            pin.log3(stoop.turn() @ waist.rotation.T),
        ]
        for point, place in (*self._feet.items(), *hands.items()):
            frame = self._tick.frame(point)
            rows.append(frame.jacobian)
            errors += [place.translation - frame.position, pin.log3(place.rotation @ frame.rotation.T)]
        return np.vstack(rows), np.concatenate(errors)

    def _step(self, q: Array, J: Array, error: Array, home: Array) -> Array:
        """A damped Newton step (nv,), and home where nothing is asked; joints stay within their ranges."""
        robot, free = self._robot, self._free.copy()
        fixed = np.where(free, home, 0.0)
        while True:
            A = np.where(free, J, 0.0)
            step: Array = fixed + A.T @ np.linalg.solve(A @ A.T + DAMPING * np.eye(len(A)), error - J @ fixed)
            step[free] = np.clip(step[free], -MAX_STEP, MAX_STEP)
            ends = np.concatenate([step[:6], np.clip(q[7:] + step[6:], robot.lower, robot.upper) - q[7:]])
            if not (beyond := free & (np.abs(step - ends) > ROUNDING)).any():
                return step
            free, fixed = free & ~beyond, np.where(beyond, ends, fixed)

    def _place(self, point: str) -> pin.SE3:
        frame = self._tick.frame(point)
        return pin.SE3(frame.rotation.copy(), frame.position.copy())


def stooped_way(arms: StoopedArms, hands: Sequence[Mapping[str, pin.SE3]], stoops: Sequence[Stoop]) -> Array:
    """Configurations (n, nq) of a robot whose hands go from place to place, each found from the one before."""
    found: list[Array] = []
    for places, stoop in zip(hands, stoops, strict=True):
        found.append(arms.reaching(places, stoop, found[-1] if found else None))
    return np.array(found)
