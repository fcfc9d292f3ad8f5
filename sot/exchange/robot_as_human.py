"""A robot's motion as a human's: whoever retargeted it, it is planned, balanced and danced as any clip is.

The key points are the robot's own: hips, knees, ankles, shoulders and so on, and pelvis, chest and head turn as its do.
Floating or sinking feet, slides and bodies in one another are dealt with as those of a human's recording are.
"""

import numpy as np
import pinocchio as pin

from sot.exchange.robot_motion import RobotMotion
from sot.motion.human.human import SIDES, Human
from sot.motion.human.mending import on_level_floor, without_jumps
from sot.motion.human.plausibility import check_plausible
from sot.motion.human.postures import standing
from sot.motion.human.world import FLOOR_PERCENTILE
from sot.motion.likeness import hip_heading

Array = np.ndarray

LIMB_POINTS = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")
POINTS = ("chest", "neck", "head", "head_top", *(f"{side}_{point}" for side in SIDES for point in LIMB_POINTS))
FRAMES = {"pelvis": "waist", "chest": "chest", "head": "head"}
"""Body of a human -> point of a robot that turns with it."""


def human_of_robot(motion: RobotMotion) -> Human:
    """The human whose joints are where a robot's are, first heading +X from the origin, on a floor at z = 0.

    Raises:
        InputError: no body moves so.
    """
    points, frames = _points_and_frames(motion)
    turn = pin.utils.rotate("z", -float(hip_heading(points)[0]))
    lowest = np.min([points[f"{side}_{point}"][:, 2] for side in SIDES for point in ("ankle", "toe")], axis=0)
    origin = np.array([*points["waist"][0, :2], np.percentile(lowest, FLOOR_PERCENTILE)])
    human = Human(
        motion.name,
        motion.rate,
        {name: (place - origin) @ turn.T for name, place in points.items()},
        {body: turn @ rotation for body, rotation in frames.items()},
    )
    return standing(on_level_floor(check_plausible(without_jumps(human))))


def _points_and_frames(motion: RobotMotion) -> tuple[dict[str, Array], dict[str, Array]]:
    """Positions (T, 3) of the points and rotations (T, 3, 3) of the frames of a human, where the robot has them."""
    robot, data = motion.robot, motion.robot.model.createData()
    numbers = {name: robot.point(name) for name in (*POINTS, *FRAMES.values())}
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    at_rest = {body: data.oMf[numbers[point]].rotation.copy() for body, point in FRAMES.items()}
    points = {name: np.empty((motion.count, 3)) for name in POINTS}
    frames = {body: np.empty((motion.count, 3, 3)) for body in FRAMES}
    for k, q in enumerate(motion.q):
        pin.framesForwardKinematics(robot.model, data, q)
        for name, place in points.items():
            place[k] = data.oMf[numbers[name]].translation
        for body, point in FRAMES.items():
            frames[body][k] = data.oMf[numbers[point]].rotation @ at_rest[body].T
    points["waist"] = 0.5 * (points["left_hip"] + points["right_hip"])
    return points, frames
