"""Kim & Oh's Figures 18-20 of the imitation: two narrowed joints, and the pelvis that is corrected for them."""

from pathlib import Path

import numpy as np
import pinocchio as pin

from scenarios.kimoh2013.kinematic import KinematicRun
from scenarios.replay import Dance
from sim.reporting.chart import Curve, Panel, limit_lines, write_panels
from sim.reporting.figures import Points
from sot.robots.robot import Robot

Array = np.ndarray

DRAWN_RATE = 100.0  # of what is drawn [Hz]
WANTED_COLOR, PHYSICS_COLOR, POSITION_COLOR = "#777", "#2b6fd9", "#d9762b"
ANGLE_NAMES = ("roll", "pitch", "yaw")


def draw_picture(path: Path, danced: Dance, position_run: KinematicRun, robot: Robot, joints: tuple[int, int]) -> None:
    """Draw the picture.

    Args:
        path: File to write (`.svg`).
        danced: The run under physics.
        position_run: The position-controlled run.
        robot: With the narrowed ranges.
        joints: Those that were narrowed.
    """
    log, motion = danced.run.log.trimmed(), danced.motion
    every = max(1, round(1.0 / (DRAWN_RATE * log.period)))
    times, end = log.time[::every], float(log.time[-1])
    wanted = np.array([np.concatenate(motion.joints(t)) for t in times]).reshape(len(times), 3, -1)
    panels = []
    for joint in joints:
        kinds = (
            ("angle [deg]", log.q[:, 7:], position_run.q[:, 7:], [robot.lower[joint], robot.upper[joint]]),
            ("speed [deg/s]", log.v[:, 6:], position_run.v[:, 6:], [-robot.velocity[joint], robot.velocity[joint]]),
            (
                "acceleration [deg/s²]",
                log.acceleration[:, 6:],
                position_run.a[:, 6:],
                [-robot.acceleration[joint], robot.acceleration[joint]],
            ),
        )
        for kind, (words, run, kinematic, ends) in enumerate(kinds):
            curves = [
                Curve(times, np.rad2deg(wanted[:, kind, joint]), WANTED_COLOR, "wanted"),
                Curve(position_run.time, np.rad2deg(kinematic[:, joint]), POSITION_COLOR, "position control"),
                Curve(times, np.rad2deg(run[::every, joint]), PHYSICS_COLOR, "physics"),
            ]
            panels.append(
                Panel(robot.joints[joint], "s", words, curves + limit_lines(np.rad2deg(ends).tolist(), end, ""))
            )
    waists = [_waist_height_and_angles(robot, q) for q in (log.q[::every], position_run.q)]
    poses = [motion.pose("waist")(t) for t in times]
    reference = np.array([[pose.position[2], *pin.rpy.matrixToRpy(pose.rotation)] for pose in poses])
    for k, words in enumerate(("height [mm]", *(f"{axis} [deg]" for axis in ANGLE_NAMES))):
        factor = 180.0 / np.pi if k else 1e3
        curves = [
            Curve(times, factor * reference[:, k], WANTED_COLOR, "desired"),
            Curve(position_run.time, factor * waists[1][:, k], POSITION_COLOR, "position control"),
            Curve(times, factor * waists[0][:, k], PHYSICS_COLOR, "physics"),
        ]
        panels.append(Panel("pelvis", "s", words, curves))
    title = f"{danced.info.clip} by {robot.label}, two joints narrowed (Kim & Oh 5.3), solver {danced.info.solver}"
    write_panels(path, title, panels, 3)


def _waist_height_and_angles(robot: Robot, q: Array) -> Array:
    """Height, roll, pitch and yaw of the waist, shape (T, 4) [m, rad]."""
    points = Points.of(robot, q, ("waist",))
    angles = [pin.rpy.matrixToRpy(rotation) for rotation in points.rotations["waist"]]
    return np.column_stack([points.positions["waist"][:, 2], angles])
