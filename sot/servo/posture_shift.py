"""A posture with its centre of mass shifted over feet that stay: what a balance command asks of the legs."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.robot import Robot

Array = np.ndarray

DAMPING = 1e-6
"""Squared damping of the inverse where legs are stretched, lengths in legs."""
TOLERANCE = 1e-6
"""Error of feet, waist and centre of mass that is good enough [m, rad]."""


class PostureShift:
    """Moves a robot's base and legs so that its centre of mass shifts, and nothing else: feet, attitude and height of
    the waist, and all joints above the legs stay where the given posture has them.

    Args:
        robot: the robot.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._data, self._wanted = robot.model.createData(), robot.model.createData()
        self._feet = [robot.point(foot) for foot in robot.feet]
        self._waist = robot.point("waist")
        legs = np.array(robot.groups["legs"])
        self._columns = np.concatenate([np.arange(6), 6 + legs])
        self._previous: Array | None = None

    def __call__(
        self,
        q: Array,
        v: Array,
        shift: Array,
        rate: Array,
        lifts: Mapping[str, Array] | None = None,
        iterations: int = 2,
    ) -> tuple[Array, Array]:
        """Posture and velocity with a shift.

        Called tick by tick it starts from its last answer, so that two iterations suffice.

        Args:
            q, v: planned state (nq,), (nv,).
            shift: of the centre of mass (2,) [m].
            rate: of the shift (2,) [m/s].
            lifts: foot -> how far it is moved (3,) [m], for those that are not to stay.
            iterations: Newton steps.

        Returns:
            (nq,), (nv,).
        """
        robot, model, columns = self._robot, self._robot.model, self._columns
        goal = pin.centerOfMass(model, self._wanted, q)[:2] + shift
        pin.updateFramePlacements(model, self._wanted)
        targets = [
            pin.SE3(at.rotation, at.translation + (lifts or {}).get(foot, 0.0))
            for foot, at in ((foot, self._wanted.oMf[k]) for foot, k in zip(robot.feet, self._feet, strict=True))
        ]
        waist = self._wanted.oMf[self._waist]
        moved = np.zeros(robot.nv) if self._previous is None else self._previous
        shifted = pin.integrate(model, q, moved)
        for _ in range(iterations):
            error, jacobian = self._error_and_jacobian(shifted, targets, waist, goal)
            step = np.zeros(robot.nv)
            step[columns] = _damped_solution(jacobian, error)
            shifted = pin.integrate(model, shifted, step)
        self._previous = pin.difference(model, q, shifted)
        _, jacobian = self._error_and_jacobian(shifted, targets, waist, goal)
        asked = np.zeros(len(jacobian))
        asked[-2:] = rate
        velocity = v.copy()
        velocity[columns] += _damped_solution(jacobian, asked)
        return shifted, velocity

    def posture(self, q: Array, shift: Array, lifts: Mapping[str, Array] | None = None, steps: int = 20) -> Array:
        """The posture (nq,) after a long way, in steps; arguments as of a call.

        Raises:
            InputError: the legs do not reach it, or their joints do not allow it.
        """
        robot, still = self._robot, np.zeros(self._robot.nv)
        for k in range(1, steps + 1):
            part = {foot: k / steps * np.asarray(lift) for foot, lift in (lifts or {}).items()}
            found, _ = self(q, still, k / steps * np.asarray(shift), np.zeros(2), part, 4)
        data = robot.model.createData()
        short = pin.centerOfMass(robot.model, data, q)[:2] + shift - pin.centerOfMass(robot.model, data, found)[:2]
        outside = np.maximum(found[7:] - robot.upper, robot.lower - found[7:])
        if np.abs(short).max() > 1e3 * TOLERANCE or outside.max() > 1e-6:
            raise InputError(f"{robot.label} cannot stand with its centre of mass there: its legs do not reach")
        return found

    def _error_and_jacobian(
        self, q: Array, targets: list[pin.SE3], waist: pin.SE3, goal: Array
    ) -> tuple[Array, Array]:
        """What is left of feet (6 each), attitude and height of the waist (4) and centre of mass (2)."""
        model, data, axes = self._robot.model, self._data, pin.LOCAL_WORLD_ALIGNED
        com_jacobian = pin.jacobianCenterOfMass(model, data, q)
        com = data.com[0][:2]
        pin.updateFramePlacements(model, data)
        errors, rows = [], []
        for frame, target in zip(self._feet, targets, strict=True):
            at = data.oMf[frame]
            errors += [target.translation - at.translation, pin.log3(target.rotation @ at.rotation.T)]
            rows.append(pin.getFrameJacobian(model, data, frame, axes))
        at = data.oMf[self._waist]
        errors += [pin.log3(waist.rotation @ at.rotation.T), [waist.translation[2] - at.translation[2]], goal - com]
        jacobian = pin.getFrameJacobian(model, data, self._waist, axes)
        rows += [jacobian[3:], jacobian[2:3], com_jacobian[:2]]
        return np.concatenate(errors), np.vstack(rows)[:, self._columns]


def _damped_solution(A: Array, b: Array) -> Array:
    x: Array = A.T @ np.linalg.solve(A @ A.T + DAMPING * np.eye(len(A)), b)
    return x
