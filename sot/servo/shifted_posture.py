"""A posture whose centre of mass is elsewhere, over feet that stay or are lifted."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.robot import Robot

Array = np.ndarray

STEPS, ITERATIONS = 20, 4
"""Parts of the way, and Newton steps in each."""
DAMPING = 1e-3
"""Of the inverse, where legs are stretched."""
TOLERANCE = 1e-3
"""Error of the centre of mass that is good enough [m]."""


def shifted_posture(robot: Robot, q: Array, shift: Array, lifts: Mapping[str, Array]) -> Array:
    """A posture (nq,) with its centre of mass shifted by base and legs; attitude and height of the waist, the joints
    above the legs and the soles' attitudes stay.

    Args:
        robot: the robot.
        q: posture to begin with (nq,).
        shift: of the centre of mass (2,) [m].
        lifts: foot -> how far it is moved (3,) [m]; the others stay.

    Raises:
        InputError: the legs do not reach it, or their joints do not allow it.
    """
    model, data = robot.model, robot.model.createData()
    columns = np.concatenate([np.arange(6), 6 + np.array(robot.groups["legs"])])
    frames = [robot.point("waist"), *(robot.point(foot) for foot in robot.feet)]
    com = pin.centerOfMass(model, data, q)[:2].copy()
    pin.updateFramePlacements(model, data)
    start = [data.oMf[frame].copy() for frame in frames]
    moves = [np.zeros(3), *(np.asarray(lifts.get(foot, np.zeros(3))) for foot in robot.feet)]
    for share in np.repeat(np.arange(1, STEPS + 1) / STEPS, ITERATIONS):
        jacobian = pin.jacobianCenterOfMass(model, data, q)[:2]
        rows, errors = [jacobian], [com + share * shift - data.com[0][:2]]
        pin.updateFramePlacements(model, data)
        for frame, at, move in zip(frames, start, moves, strict=True):
            place, own = data.oMf[frame], slice(2, 6) if frame == frames[0] else slice(0, 6)
            turn = pin.log3(at.rotation @ place.rotation.T)
            errors.append(np.concatenate([at.translation + share * move - place.translation, turn])[own])
            rows.append(pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[own])
        J = np.vstack(rows)[:, columns]
        step = np.zeros(robot.nv)
        step[columns] = J.T @ np.linalg.solve(J @ J.T + DAMPING**2 * np.eye(len(J)), np.concatenate(errors))
        q = pin.integrate(model, q, step)
    short = com + shift - pin.centerOfMass(model, data, q)[:2]
    if np.abs(short).max() > TOLERANCE or np.any((q[7:] > robot.upper + 1e-6) | (q[7:] < robot.lower - 1e-6)):
        raise InputError(f"{robot.label} cannot stand with its centre of mass there: its legs do not reach")
    return q
