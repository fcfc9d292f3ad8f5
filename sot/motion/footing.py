"""Standing on given footholds: configurations whose soles lie flat on them, the centre of mass over a place."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface

Array = np.ndarray

SEARCH_STEPS = 40
MAX_STEP_LENGTH = 0.01
"""Bound of the way of the centre of mass in one step of the search [m]."""
REACH_TOLERANCE = 2e-3
"""Error of feet and centre of mass that are where they should be [m and rad]."""
TRUNK_WEIGHT, REST_WEIGHT = 1e-2, 1e-3
"""Weights of an upright trunk at its height, and of small steps, beside feet and centre of mass."""


class Footing(NamedTuple):
    """A robot that stands.

    Attributes:
        q: Configuration (nq,).
        feet: Foot -> its place in the world.
        reached: Whether the soles are on their footholds with the centre of mass where it should be.
    """

    q: Array
    feet: Mapping[str, pin.SE3]
    reached: bool


def footing_on(robot: Robot, on: Mapping[str, Surface]) -> Footing:
    """The robot with its feet moved from where they are at rest up or down onto surfaces of the world, and laid flat.

    Args:
        robot: Who stands.
        on: Foot -> surface under it; the floor unless given. Surfaces count as if they had no edge.
    """
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.rest)
    feet = {}
    for foot in robot.feet:
        place, axes = data.oMf[robot.point(foot)], on.get(foot, FLOOR).placement
        normal = axes.rotation[:, 2]
        rise = normal @ (axes.translation - place.translation) / normal[2]
        tilt = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), normal).matrix()
        feet[foot] = pin.SE3(tilt @ place.rotation, place.translation + np.array([0.0, 0.0, rise]))
    com = pin.centerOfMass(model, data, robot.rest)[:2].copy()
    lowest = min(place.translation[2] for place in feet.values())
    return footing_at(robot, feet, com, robot.rest[2] + lowest)


def footing_at(robot: Robot, feet: Mapping[str, pin.SE3], com: Array, height: float | None = None) -> Footing:
    """The robot with its feet in given places, within all ranges of its joints: Gauss-Newton over base and legs.

    Args:
        robot: Who stands.
        feet: Foot -> place of its frame in the world.
        com: Where the centre of mass is to be (2,) [m].
        height: Of the base, as nearly as the legs allow [m]; free unless given.
    """
    model, data = robot.model, robot.model.createData()
    moving = np.concatenate([np.arange(6), 6 + robot.joint_numbers("legs")])
    q = robot.rest.copy()
    upright = pin.XYZQUATToSE3(robot.rest[:7]).rotation
    for _ in range(SEARCH_STEPS):
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        J_com = pin.jacobianCenterOfMass(model, data, q)
        away = com - data.com[0][:2]
        rows, wanted = [J_com[:2]], [away * min(1.0, MAX_STEP_LENGTH / max(float(np.linalg.norm(away)), 1e-9))]
        for name, place in feet.items():
            frame = robot.point(name)
            rows.append(pin.getFrameJacobian(model, data, frame, pin.LOCAL))
            wanted.append(pin.log6(data.oMf[frame].actInv(place)).vector)
        tilt = pin.log3(data.oMi[1].rotation.T @ upright)
        rows += [TRUNK_WEIGHT * np.eye(model.nv)[3:6], REST_WEIGHT * np.eye(model.nv)]
        wanted += [TRUNK_WEIGHT * tilt, np.zeros(model.nv)]
        if height is not None:
            lift = np.zeros((1, model.nv))
            lift[0, :3] = data.oMi[1].rotation[2]
            rows.append(TRUNK_WEIGHT * lift)
            wanted.append(TRUNK_WEIGHT * np.array([height - q[2]]))
        step = np.zeros(model.nv)
        step[moving] = np.linalg.lstsq(np.vstack(rows)[:, moving], np.concatenate(wanted), rcond=None)[0]
        q = pin.integrate(model, q, step)
        q[7:] = np.clip(q[7:], robot.lower, robot.upper)
    pin.centerOfMass(model, data, q)
    pin.framesForwardKinematics(model, data, q)
    off = [float(np.linalg.norm(com - data.com[0][:2]))]
    off += [
        float(np.abs(pin.log6(data.oMf[robot.point(name)].actInv(place)).vector).max()) for name, place in feet.items()
    ]
    return Footing(q, feet, max(off) < REACH_TOLERANCE)
