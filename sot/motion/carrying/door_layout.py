"""A door with a lever as the robot before it sees it."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DoorLayout:
    """A door as a robot at the origin sees it: the hinge is on the left, and the door opens away.

    The lever's bar points to the left, and its free end is pressed down.

    Attributes:
        hinge: place of its axis (2,) [m].
        face: distance of the leaf's near face from the axis, towards the robot [m].
        grip: distance from the axis, along the leaf, at which it is pushed [m].
        lever: place of the lever's axis (3,), where the bar is [m].
        press: distance from this axis at which the bar is pressed [m].
        bar: radius of the bar [m].
        stiffness, lever_stiffness: of the springs [N m/rad].
        inertia: of the leaf about its hinge [kg m²].
        pressed: angle of the lever at which the bolt is back [rad].
        unlatched: angle of the leaf at which the bolt is past the frame [rad].
        opened: angle to which it is opened [rad].
        exit: place ahead that the body has to reach [m].
    """

    hinge: Array
    face: float
    grip: float
    lever: Array
    press: float
    bar: float
    stiffness: float
    inertia: float
    lever_stiffness: float
    pressed: float
    unlatched: float
    opened: float
    exit: float

    def leaf(self, angle: float) -> pin.SE3:
        """Placement of the leaf, relative to where it is closed."""
        turn = pin.utils.rotate("z", angle)
        axis = np.array([*self.hinge, 0.0])
        return pin.SE3(turn, axis - turn @ axis)

    def pushed(self, angle: float) -> Array:
        """Place on the floor below the point of the leaf that is pushed (3,) [m]."""
        point: Array = self.leaf(angle).act(np.array([self.hinge[0] - self.face, self.hinge[1] - self.grip, 0.0]))
        return point

    def on_lever(self, angle: float) -> tuple[Array, Array]:
        """Place (3,) on the closed door's bar that is pressed [m], and which way its skin faces there (3,)."""
        along, out = along_and_out(np.array([angle]))
        return self.lever + self.press * along[0] + self.bar * out[0], out[0]

    def leaf_force(self, angle: Array, acceleration: Array) -> Array:
        """Force (T, 3) of the leaf and its spring on a hand that pushes, at angles and their accelerations (T,) [N]."""
        normal = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(len(angle))])
        force: Array = -((self.stiffness * angle + self.inertia * acceleration) / self.grip)[:, None] * normal
        return force

    def lever_force(self, angle: Array, lever: Array) -> Array:
        """Force (T, 3) of the lever's spring on a hand that presses, at angles (T,) of leaf and lever [N]."""
        _, out = along_and_out(lever)
        turns = np.array([pin.utils.rotate("z", a) for a in angle.tolist()])
        force: Array = np.einsum("tij,tj->ti", turns, out) * (self.lever_stiffness / self.press * lever)[:, None]
        return force


def along_and_out(angle: Array) -> tuple[Array, Array]:
    """Directions (T, 3) along a bar that is turned by angles (T,) from level, and upwards off it."""
    c, s, nothing = np.cos(angle), np.sin(angle), np.zeros(len(angle))
    return np.column_stack([nothing, c, -s]), np.column_stack([nothing, s, c])
