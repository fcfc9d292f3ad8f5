"""Compliant feet: a rubber bush between each ankle and its sole."""

from dataclasses import dataclass
from math import cos, inf, isfinite, sin, sqrt

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.robots.robot import Robot

BUSH_HEIGHT_RATIO = 1.0 / 3.0
"""Height of a bush above the sole, of the ankle's."""
SOLE_MASS_SHARE = 1.0 / 3.0
"""Share of a foot's mass and inertia that is below the bush."""
DEFAULT_LOSS = 0.035
"""Damping over stiffness [s], of √(l / g): 10 ms for a body 0.8 m above its bushes."""


@dataclass(frozen=True)
class FootCompliance:
    """Springs and dampers between each foot and its sole, about the axes of the foot frame through the bush.

    Attributes:
        roll: stiffness about x, forward [N m/rad].
        pitch: stiffness about y, to the left [N m/rad].
        vertical: stiffness along z [N/m]; infinite where the sole cannot move so.
        loss: damping over stiffness [s], as a share of √(l / g), l the height of the CoM above the bushes at rest.

    Raises:
        InputError: a stiffness that is not positive, or a loss that is negative.
    """

    roll: float
    pitch: float
    vertical: float = inf
    loss: float = DEFAULT_LOSS

    def __post_init__(self) -> None:
        stiffnesses = {"roll": self.roll, "pitch": self.pitch}
        if not all(isfinite(value) and value > 0.0 for value in stiffnesses.values()) or not self.vertical > 0.0:
            raise InputError(
                f"foot compliance {self.roll:g}, {self.pitch:g}, {self.vertical:g}: stiffnesses must be positive"
            )
        if not 0.0 <= self.loss < inf:
            raise InputError(f"foot compliance loss={self.loss:g}: must not be negative")

    def relaxation_time(self, robot: Robot) -> float:
        """Damping over stiffness [s]."""
        return self.loss * sqrt(pendulum_length(robot) / GRAVITY)


def bush_position(robot: Robot, foot: str) -> np.ndarray:
    """The middle of a foot's bush (3,) in the foot frame [m]: under the ankle, a third of its height above the sole."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    ankle = data.oMf[robot.point(foot.replace("foot", "ankle"))].translation
    at: np.ndarray = data.oMf[robot.point(foot)].actInv(ankle)
    at[2] *= BUSH_HEIGHT_RATIO
    return at


def sole_in_foot(bush: np.ndarray, deflection: np.ndarray) -> pin.SE3:
    """Where the foot frame goes that is fixed to the sole, seen from the foot.

    Args:
        bush: its middle in the foot frame (3,) [m].
        deflection: roll, pitch [rad] and height [m] by which the sole is off (3,); pitch turns after roll.
    """
    roll, pitch, height = deflection.tolist()
    (cr, sr), (cp, sp) = (cos(roll), sin(roll)), (cos(pitch), sin(pitch))
    turn = np.array([[cp, 0.0, sp], [sr * sp, cr, -sr * cp], [-cr * sp, sr, cr * cp]])
    return pin.SE3(turn, bush - turn @ bush + np.array([0.0, 0.0, height]))


def pendulum_length(robot: Robot) -> float:
    """Height of the centre of mass above the bushes at rest [m]."""
    com = pin.centerOfMass(robot.model, robot.model.createData(), robot.rest)
    return float(com[2] - bush_position(robot, robot.feet[0])[2])
