"""Arms that hold a box before a body that moves after a human: fitted to where the box is to be.

The rest of the body is given. Palms lie flat on the box's sides, and the box is level; where arms, and a chest that
turns a little, do not reach, it is beside its way.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.limits import Limits
from sot.motion.body.retarget import PartFit
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets
from sot.motion.human.human import SEGMENTS
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

GRIP_WEIGHT = 1.0 / 0.0005  # 1/m, of the palms' places on the box
PALM_TURN_WEIGHT = 1.0 / 0.002  # 1/rad, of palms that lie flat
WAY_WEIGHT = 1.0 / 0.03  # 1/m, of the box's distance from its way
SEGMENT_WEIGHT = 1.0 / 0.05  # of the directions of upper arms and forearms, while nothing is held
CHEST_TURN_WEIGHT = 1.0 / 0.15  # 1/rad, of the chest's joints off what the body has
POSTURE_WEIGHT = 1.0 / 2.0  # 1/rad, of the arms' joints off rest
GAUSS_NEWTON_STEPS = 8  # over the whole clip, from arms that are the human's


@dataclass(frozen=True)
class HeldBox:
    """What a box asks of arms, at T knots.

    Attributes:
        way: of its middle (T, 3) [m].
        turn: which way it faces (T,) [rad].
        hands: hand -> its place in the box's axes while it holds it; two.
        gap: of the palms from the box's sides (T,) [m].
        share: 1 where arms hold the box, 0 where they are as the human's (T,).
    """

    way: Array
    turn: Array
    hands: Mapping[str, pin.SE3]
    gap: Array
    share: Array


class HeldArms:
    """Both arms, and the chest's joints: a `sot.motion.body.parts.Part`.

    Args:
        robot: whose arms they are.
        wanted: of the body, for while nothing is held.
        planned: coordinates (T, nv) of which the chest's are kept to.
        box: what is held.
    """

    def __init__(self, robot: Robot, wanted: Targets, planned: Array, box: HeldBox) -> None:
        chest, arms = (6 + np.sort(np.array(robot.groups[name], dtype=int)) for name in ("chest", "arms"))
        self.columns: Indices = np.sort(np.concatenate([chest, arms]))
        self._own = planned.copy()
        self._own[:, arms] = robot.rest[1 + arms]
        self._weights = np.where(np.isin(self.columns, chest), CHEST_TURN_WEIGHT, POSTURE_WEIGHT)
        self._chains, self._box = JointTree(robot), box
        self._hands = [(robot.point(name), place) for name, place in box.hands.items()]
        self._segments = [
            (robot.point(near), robot.point(far), wanted.directions[name])
            for name, (near, far) in SEGMENTS.items()
            if name.endswith(("upper_arm", "forearm"))
        ]

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        """Weighted errors (n, rows) at n knots for coordinates y (n, nv), and their Jacobians (n, rows, s)."""
        box, kinematics, size = self._box, Kinematics(self._chains, y, self.columns), len(self.columns)
        turn, share = Rotation.from_euler("z", box.turn[knots][:, None]).as_matrix(), box.share[knots][:, None]
        places, errors, jacobians = [], [], []

        def add(weight: float | Array, error: Array, jacobian: Array) -> None:
            errors.append(weight * error)
            jacobians.append(np.broadcast_to(weight, error.shape)[:, :, None] * jacobian)

        for frame, place in self._hands:
            outward = np.sign(place.translation[1]) * np.outer(box.gap[knots], [0.0, 1.0, 0.0])
            arm = np.einsum("nij,nj->ni", turn, place.translation + outward)
            places.append(kinematics.position_residual(frame, box.way[knots] + arm))
            add(PALM_TURN_WEIGHT * share, *kinematics.orientation_residual(frame, turn @ place.rotation))
        (first, J_first), (second, J_second) = places
        add(GRIP_WEIGHT * share, first - second, J_first - J_second)
        add(WAY_WEIGHT * share, 0.5 * (first + second), 0.5 * (J_first + J_second))
        for near, far, way in self._segments:
            add(SEGMENT_WEIGHT * (1.0 - share), *kinematics.direction_residual(near, far, way[knots]))
        eye = np.broadcast_to(np.eye(size), (len(y), size, size))
        add(self._weights, y[:, self.columns] - self._own[knots][:, self.columns], eye)
        return np.concatenate(errors, axis=1), np.concatenate(jacobians, axis=1)


def with_box_held(robot: Robot, wanted: Targets, limits: Limits, body_motion: Spline, box: HeldBox) -> Spline:
    """A body's motion with arms that hold a box, under their limits.

    Args:
        robot: whose body it is.
        wanted: of the body.
        limits: of its coordinates.
        body_motion: the motion of all coordinates.
        box: what is held.
    """
    y, control = body_motion.knots, body_motion.control.copy()
    part = HeldArms(robot, wanted, y, box)
    fit = PartFit(part.columns, len(y), body_motion.period, limits)
    control[:, part.columns] = fit.refine(
        part, Spline(control[:, part.columns], body_motion.period), y, GAUSS_NEWTON_STEPS
    ).control
    return Spline(control, body_motion.period)


def held_places(robot: Robot, y: Array, hands: Mapping[str, pin.SE3]) -> list[pin.SE3]:
    """Where a level box is (T,) that two hands hold at coordinates (T, nv).

    Args:
        robot: whose hands they are.
        y: its coordinates.
        hands: hand -> its place in the box's axes.
    """
    kinematics = Kinematics(JointTree(robot), y)
    (first, second), own = (kinematics.frame_pose(robot.point(name))[1] for name in hands), [*hands.values()]
    across, along = first - second, own[0].translation - own[1].translation
    turn = np.unwrap(np.arctan2(across[:, 1], across[:, 0]) - np.arctan2(along[1], along[0]))
    rotation = Rotation.from_euler("z", turn[:, None]).as_matrix()
    middle = 0.5 * (first + second) - rotation @ (0.5 * (own[0].translation + own[1].translation))
    return [pin.SE3(axes, place) for axes, place in zip(rotation, middle, strict=True)]
