"""Where the centre of mass may be for all standing legs to reach their feet within their joints' ranges."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath, feet_heading
from sot.polygon import Polygon
from sot.robots.leg_range import normals
from sot.robots.robot import Robot

Array = NDArray[np.float64]


class ComReach:
    """Each ankle of a standing foot is below its hip, or off it by what the leg's joints reach (`LegReach.carrying`).

    With the pelvis where it is from the centre of mass, that is a polygon for the centre of mass at every knot.
    """

    def __init__(self, robot: Robot, build: Build, feet: Mapping[str, FootPath]):
        """
        Args:
            robot: whose legs.
            build: of the robot.
            feet: their paths over the clip.
        """
        self._robot, self._build, self._reach = robot, build, LegReach.of(robot)
        self._tree, self._heading = JointTree(robot), feet_heading(feet)
        cosine, sine = np.cos(self._heading), np.sin(self._heading)
        self._ways = normals() @ np.array([[cosine, sine], [-sine, cosine]]).transpose(2, 0, 1)  # (T, 2 EDGES, 2)
        left = np.column_stack([-sine, cosine])
        self._limits = []  # for each foot: knots at which it stands, least of the hips' middle along the ways
        for foot, path in feet.items():
            side = 0.5 * self._reach.hip_width * (1.0 if foot == robot.feet[0] else -1.0)
            sole = np.mean(robot.sole(foot), axis=0) - np.append(np.mean(self._reach.soles[foot], axis=0), 0.0)
            ankle = path.position[:, :2] + (path.rotation @ sole)[:, :2]
            least = np.einsum("tki,ti->tk", self._ways, ankle - side * left) - self._reach.carrying[foot]
            self._limits.append((path.free == 0.0, least))

    def nearest(self, wanted: Array, com: Array, y: Array, first: int) -> Array:
        """The places (n, 2) within reach that are nearest to wanted ones of the centre of mass, from a knot on [m].

        Args:
            wanted: (n, 2).
            com: (n, 2) where it is, with the body at coordinates y (n, nv).
            y: (n, nv).
            first: knot.
        """
        rotation, waist = Kinematics(self._tree, y).frame_pose(self._robot.point("waist"))
        off = (waist + rotation @ self._build.hips)[:, :2] - com
        found, rows = wanted.copy(), np.arange(first, first + len(wanted))
        ways = self._ways[rows]
        along = np.einsum("tki,ti->tk", ways, wanted + off)
        bounds = [(stands[rows], least[rows]) for stands, least in self._limits]
        short = np.zeros(len(wanted), bool)
        for stands, least in bounds:
            short |= stands & (along < least).any(axis=1)
        for n in np.flatnonzero(short):
            edges = [-least[n] for stands, least in bounds if stands[n]]
            polygon = Polygon(np.vstack([-ways[n]] * len(edges)), np.concatenate(edges))
            found[n] = polygon.nearest_point(wanted[n] + off[n]) - off[n]
        return found
