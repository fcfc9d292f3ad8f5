"""Arms whose hands are led through a scene while the body moves by a plan of its own: fitted over the whole motion.

Points of the hands' surfaces are where they should be, and the surfaces face where they should, as far as arms and a
chest that turns with them reach.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.limits import Limits
from sot.motion.body.retarget import PartFit
from sot.motion.body.spline import Spline
from sot.robots.robot import Robot
from sot.robots.surface import Surface

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

PLACE_WEIGHT = 1.0 / 0.001  # 1/m, of a surface's place
CHEST_TURN_WEIGHT = 1.0 / 0.5  # 1/rad, of the chest's joints off what the body has
POSTURE_WEIGHT = 1.0 / 2.0  # 1/rad, of the arms' joints off rest
MIN_LENGTH = 1e-9  # of directions
STAGES = 6  # in which hands go from where the body's motion has them to where they are led: straight into one posture
GAUSS_NEWTON_STEPS = 2  # over the whole motion, in each stage


@dataclass(frozen=True)
class LedSurface:
    """Where a surface of a hand is to be at T knots.

    Attributes:
        surface: of the robot.
        place: of its middle (T, 3) [m].
        outward: unit vectors along which it faces (T, 3).
        tilt: off that direction that is accepted (T,) [rad].
    """

    surface: Surface
    place: Array
    outward: Array
    tilt: Array


class LedArms:
    """Both arms, and the chest's joints: a `sot.motion.body.parts.Part`.

    Args:
        robot: whose arms they are.
        body: coordinates (T, nv) of which the chest's are kept to.
        hands: where surfaces are to be.
    """

    def __init__(self, robot: Robot, body: Array, hands: Sequence[LedSurface]) -> None:
        chest, arms = (6 + np.sort(np.array(robot.groups[name], dtype=int)) for name in ("chest", "arms"))
        self.columns: Indices = np.sort(np.concatenate([chest, arms]))
        self._own = body.copy()
        self._own[:, arms] = robot.rest[1 + arms]
        self._weights = np.where(np.isin(self.columns, chest), CHEST_TURN_WEIGHT, POSTURE_WEIGHT)
        self._chains, self._hands = JointTree(robot), hands
        self._frames = [_frame(robot, hand.surface) for hand in hands]

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        """Weighted errors (n, rows) at n knots for coordinates y (n, nv), and their Jacobians (n, rows, s)."""
        kinematics, size = Kinematics(self._chains, y, self.columns), len(self.columns)
        errors, jacobians = [], []
        for frame, hand in zip(self._frames, self._hands, strict=True):
            middle = hand.surface.placement.translation
            ahead = middle + hand.surface.placement.rotation[:, 2]
            off, J = kinematics.position_residual(frame, hand.place[knots], middle)
            off_ahead, J_ahead = kinematics.position_residual(frame, hand.place[knots] + hand.outward[knots], ahead)
            turn_weight = 1.0 / hand.tilt[knots][:, None]
            errors += [PLACE_WEIGHT * off, turn_weight * (off_ahead - off)]
            jacobians += [PLACE_WEIGHT * J, turn_weight[:, :, None] * (J_ahead - J)]
        eye = np.broadcast_to(np.eye(size), (len(y), size, size))
        errors.append(self._weights * (y[:, self.columns] - self._own[knots][:, self.columns]))
        jacobians.append(self._weights[:, None] * eye)
        return np.concatenate(errors, axis=1), np.concatenate(jacobians, axis=1)


def with_hands_led(robot: Robot, limits: Limits, body_motion: Spline, hands: Sequence[LedSurface]) -> Spline:
    """A body's motion with arms that lead hands, under their limits.

    Args:
        robot: whose body it is.
        limits: of its coordinates.
        body_motion: the motion of all coordinates.
        hands: where surfaces of the hands are to be.
    """
    y, control = body_motion.knots, body_motion.control.copy()
    start = led_surfaces(robot, y, hands)
    columns = LedArms(robot, y, hands).columns
    fit, arms = PartFit(columns, len(y), body_motion.period, limits), Spline(control[:, columns], body_motion.period)
    for stage in range(1, STAGES + 1):
        goals = [_between(*pair, stage / STAGES) for pair in zip(start, hands, strict=True)]
        arms = fit.refine(LedArms(robot, y, goals), arms, y, GAUSS_NEWTON_STEPS)
    control[:, columns] = arms.control
    return Spline(control, body_motion.period)


def _between(start: LedSurface, goal: LedSurface, share: float) -> LedSurface:
    """What is a share of the way from one thing asked to another."""
    facing = start.outward + share * (goal.outward - start.outward)
    return replace(
        goal,
        place=start.place + share * (goal.place - start.place),
        outward=facing / np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), MIN_LENGTH),
    )


def led_surfaces(robot: Robot, y: Array, hands: Sequence[LedSurface]) -> list[LedSurface]:
    """Where surfaces of hands are, and which way they face, at coordinates (T, nv)."""
    kinematics, found = Kinematics(JointTree(robot), y), []
    for hand in hands:
        rotation, position = kinematics.frame_pose(_frame(robot, hand.surface))
        own = hand.surface.placement
        found.append(replace(hand, place=position + rotation @ own.translation, outward=rotation @ own.rotation[:, 2]))
    return found


def surface_turns(robot: Robot, y: Array, surface: Surface) -> Array:
    """Rotations (T, 3, 3) of the point that a surface belongs to, at coordinates (T, nv)."""
    return Kinematics(JointTree(robot), y).frame_pose(_frame(robot, surface))[0]


def _frame(robot: Robot, surface: Surface) -> int:
    assert surface.point is not None
    return robot.point(surface.point)
