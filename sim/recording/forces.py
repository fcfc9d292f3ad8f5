"""Forces in a recording: those of the floor on the feet, and pushes."""

from collections.abc import Sequence

import numpy as np
import rerun as rr

from sim.log import RunLog
from sim.push import Push
from sim.recording.bodies import point_poses
from sim.recording.columns import COLORS, Columns
from sot.robots.robot import Robot

METRES_PER_NEWTON = 1e-3  # length of a force arrow
PUSH_METRES_PER_NEWTON = 4e-3  # a push is weaker than a weight


def send_forces(columns: Columns, log: RunLog, robot: Robot, rows: np.ndarray) -> None:
    """Send the floor's force on each foot: an arrow from below whose tip is the centre of pressure."""
    origins, _ = point_poses(robot, robot.feet, log.q[rows])
    for foot, name in enumerate(robot.feet):
        wrench = log.foot_wrench[rows, foot]
        loaded = wrench[:, 2] > 1.0
        force, moment = wrench[loaded, :3], wrench[loaded, 3:]
        origin = origins[foot, loaded]
        origin[:, 0] -= moment[:, 1] / force[:, 2]
        origin[:, 1] += moment[:, 0] / force[:, 2]
        entity = f"world/contact/{name}"
        columns.static(entity, rr.Arrows3D.from_fields(colors=[COLORS["measured"]], radii=[0.008]))
        arrow = METRES_PER_NEWTON * force
        arrows = rr.Arrows3D.columns(vectors=arrow, origins=origin - arrow)
        columns.over_time(entity, log.time[rows], arrows.partition(loaded.astype(int)))


def send_pushes(columns: Columns, log: RunLog, pushes: Sequence[Push], robot: Robot, rows: np.ndarray) -> None:
    """Send pushes: an arrow onto the pushed body while the push lasts."""
    for index, push in enumerate(pushes):
        acting = rows[[push.is_acting(t) for t in log.time[rows]]]
        if not len(acting):
            continue
        tips = point_poses(robot, [push.body], log.q[acting])[0][0]
        entity, arrow = f"world/push/{index}", PUSH_METRES_PER_NEWTON * np.array(push.force)
        columns.static(entity, rr.Arrows3D.from_fields(colors=[COLORS["limit"]], radii=[0.015]))
        shown = rr.Arrows3D.columns(vectors=np.tile(arrow, (len(tips), 1)), origins=tips - arrow)
        # What is logged last stays: an empty row takes the arrow away.
        columns.over_time(entity, np.append(log.time[acting], push.end), shown.partition([1] * len(tips) + [0]))
