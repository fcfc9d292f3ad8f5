"""The plane that feet walk on, level or not, and what was planned for the floor laid onto it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.feet.contacts import Phase
from sot.motion.feet.swing import FootPath
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
EDGE_TOLERANCE = 1e-6  # m, by which a sole may be over the edge of what it stands on


class Ground:
    """The plane of a surface of the world. What is laid onto it keeps its horizontal place and its height above it.

    Args:
        surface: that is walked on.

    Attributes:
        tilt: rotation (3, 3) that lays a level sole flat on it.

    Raises:
        InputError: the surface moves, or friction does not hold a sole on it.
    """

    def __init__(self, surface: Surface = FLOOR) -> None:
        if surface.point is not None:
            raise InputError(f"{surface.name} is no ground to walk on: it is part of '{surface.owner}', which moves")
        self.surface, normal = surface, surface.axes.rotation[:, 2]
        slope = float(np.arccos(np.clip(normal[2], -1.0, 1.0)))
        if np.tan(slope) > surface.friction or slope > 0.5 * np.pi - EDGE_TOLERANCE:
            raise InputError(
                f"{surface.name} is too steep to walk on: {np.degrees(slope):.0f} degrees, and its friction of"
                f" {surface.friction:g} holds a sole up to {np.degrees(np.arctan(surface.friction)):.0f}"
            )
        self.tilt: Array = pin.Quaternion.FromTwoVectors(UP, normal).matrix()

    def height(self, places: Array) -> Array:
        """Height (...,) of the ground at horizontal places (..., 2) [m]."""
        return self.surface.height_at(places)

    def laid(self, pose: pin.SE3) -> pin.SE3:
        """The pose on this ground of what is at a pose on the level floor."""
        x, y, above = pose.translation
        foot = np.array([x, y, float(self.height(pose.translation[:2]))])
        return pin.SE3(self.tilt @ pose.rotation, foot + above * self.tilt[:, 2])

    def laid_phases(self, robot: Robot, phases: Sequence[Phase]) -> tuple[Phase, ...]:
        """Contact phases of the level floor on this ground.

        Raises:
            InputError: a sole would be beyond the edge of the surface.
        """
        found = []
        for phase in phases:
            feet = {foot: self.laid(pose) for foot, pose in phase.feet.items()}
            for foot, pose in feet.items():
                self._check_inside(foot, phase.start, np.array([pose.act(corner) for corner in robot.sole(foot)]))
            found.append(replace(phase, feet=feet, surfaces=dict.fromkeys(feet, self.surface)))
        return tuple(found)

    def laid_paths(self, paths: Mapping[str, FootPath]) -> dict[str, FootPath]:
        """Paths of feet over the level floor on this ground."""
        found = {}
        for foot, path in paths.items():
            below = path.position * [1.0, 1.0, 0.0]
            below[:, 2] = self.height(path.position[:, :2])
            position = below + path.position[:, 2:] * self.tilt[:, 2]
            found[foot] = replace(path, position=position, rotation=self.tilt @ path.rotation)
        return found

    def _check_inside(self, foot: str, start: float, sole: Array) -> None:
        margin = float(self.surface.edge_margins(sole).min())
        if margin < -EDGE_TOLERANCE:
            raise InputError(
                f"{foot} would stand {-1e2 * margin:.0f} cm beyond the edge of {self.surface.name} from"
                f" {start:.1f} s on: make it longer, or walk less far"
            )
