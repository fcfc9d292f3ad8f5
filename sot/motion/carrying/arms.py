"""Arms that reach: places of hands before a robot at rest, and the angles of the arms there."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.robot import Robot

Array = np.ndarray

MAX_ARM_WAY = 0.1  # m and rad, of a hand, before its arm is solved for anew
ARM_STEPS = 30  # Newton steps of the arms' inverse kinematics, at most
DAMPING = 1e-5  # of these steps, beside squared lengths [m²]
ARM_TOLERANCE, ROUNDING = 1e-3, 1e-9  # m and rad
ORIGIN = np.zeros(3)


class Arms:
    """Inverse kinematics of the arms of a robot whose trunk is as at rest; places count from the waist.

    Args:
        robot: whose arms they are.

    Attributes:
        joints: numbers of the arms' joints (k,).
        chest: place of the chest (3,) [m].
    """

    def __init__(self, robot: Robot) -> None:
        self._robot, self._data = robot, robot.model.createData()
        self.joints = robot.joint_numbers("arms")
        pin.framesForwardKinematics(robot.model, self._data, robot.rest)
        self._waist = self._data.oMf[robot.point("waist")].translation.copy()
        self.chest = self._data.oMf[robot.point("chest")].translation - self._waist

    def reaching(self, goals: Mapping[str, pin.SE3], start: Array | None = None) -> Array:
        """Angles of the arms' joints (k,) with which hands are where they should be.

        Args:
            goals: hand -> place of its frame.
            start: angles from which the arms go there, by the straightest way; at rest unless given.

        Raises:
            InputError: arms do not reach.
        """
        robot, q = self._robot, self._robot.rest.copy()
        if start is not None:
            q[7 + self.joints] = start
        pin.framesForwardKinematics(robot.model, self._data, q)
        begin = {point: self._data.oMf[robot.point(point)].copy() for point in goals}
        ways = {point: pin.log6(begin[point].actInv(self._in_world(goal))) for point, goal in goals.items()}
        longest = max(float(np.abs(way.vector).max()) for way in ways.values())
        count = max(int(np.ceil(longest / MAX_ARM_WAY)), 1)
        error = np.inf
        for k in range(count):
            aims = {point: begin[point] * pin.exp6(way * ((k + 1) / count)) for point, way in ways.items()}
            for _ in range(ARM_STEPS):
                q, error = self._nearer(q, aims)
                if error < ROUNDING:
                    break
        if error > ARM_TOLERANCE:
            raise InputError(
                f"the arms of {robot.label} do not reach where its hands should be, by {error:.2f} m or rad"
            )
        return q[7 + self.joints]

    def _in_world(self, place: pin.SE3) -> pin.SE3:
        return pin.SE3(place.rotation, place.translation + self._waist)

    def _nearer(self, q: Array, aims: Mapping[str, pin.SE3]) -> tuple[Array, float]:
        """A Newton step of the arms towards places of the hands, within the joints' ranges; and the error before it."""
        robot, data = self._robot, self._data
        pin.computeJointJacobians(robot.model, data, q)
        pin.updateFramePlacements(robot.model, data)
        rows, errors = [], []
        for point, aim in aims.items():
            frame = robot.point(point)
            rows.append(pin.getFrameJacobian(robot.model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:, 6 + self.joints])
            errors += [
                aim.translation - data.oMf[frame].translation,
                pin.log3(aim.rotation @ data.oMf[frame].rotation.T),
            ]
        error = np.concatenate(errors)
        J, step = np.vstack(rows), np.zeros(robot.nv)
        step[6 + self.joints] = J.T @ np.linalg.solve(J @ J.T + DAMPING * np.eye(len(J)), error)
        nearer = pin.integrate(robot.model, q, step)
        nearer[7:] = np.clip(nearer[7:], robot.lower, robot.upper)
        return nearer, float(np.abs(error).max())


def palm_places(robot: Robot, width: float, pitch: float, middle: Array = ORIGIN) -> dict[str, pin.SE3]:
    """Places of the frames of hands whose palms face each other, level, in axes of which x points ahead and z up.

    Args:
        robot: whose hands they are.
        width: between the palms [m].
        pitch: by which the fingers point down [rad].
        middle: between the palms (3,) [m].
    """
    places = {}
    fingers = np.array([np.cos(pitch), 0.0, -np.sin(pitch)])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        palm, tip = robot.surface(f"{side}_palm"), robot.surface(f"{side}_hand_end")
        assert palm.point is not None
        inward, own, end = np.array([0.0, -sign, 0.0]), palm.placement.rotation[:, 2], tip.placement.rotation[:, 2]
        turn = np.column_stack([inward, fingers, np.cross(inward, fingers)])
        turn = turn @ np.column_stack([own, end, np.cross(own, end)]).T
        touch = middle - 0.5 * width * inward
        places[palm.point] = pin.SE3(turn, touch - turn @ palm.placement.translation)
    return places


def fist_places(robot: Robot, apart: float, middle: Array) -> dict[str, pin.SE3]:
    """Places of the frames of hands whose ends point straight ahead, the palms facing each other.

    Args:
        robot: whose hands they are.
        apart: distance of the hands' ends [m].
        middle: between the ends (3,) [m].
    """
    places = {}
    for side, sign in (("left", 1.0), ("right", -1.0)):
        palm, tip = robot.surface(f"{side}_palm"), robot.surface(f"{side}_hand_end")
        assert tip.point is not None
        inward, own, end = np.array([0.0, -sign, 0.0]), palm.placement.rotation[:, 2], tip.placement.rotation[:, 2]
        ahead = np.array([1.0, 0.0, 0.0])
        turn = np.column_stack([inward, ahead, np.cross(inward, ahead)])
        turn = turn @ np.column_stack([own, end, np.cross(own, end)]).T
        places[tip.point] = pin.SE3(turn, middle - 0.5 * apart * inward - turn @ tip.placement.translation)
    return places
