"""How near a robot that carried a box after a clip came to its plan and to the human."""

import numpy as np
import pinocchio as pin

from scenarios.otani2017.carrying.clip import ClipCarry
from sim.log import RunLog
from sot.motion.body.targets import UPPER_BODY_SEGMENTS, Targets, key_points
from sot.motion.human.human import SIDES
from sot.motion.plan import Plan
from sot.robots.robot import Robot

Array = np.ndarray

UPPER_BODY = ("chest", "head", *(f"{side}_{part}" for part in ("shoulder", "elbow", "wrist") for side in SIDES))
"""Points that tell how near the upper body is to its plan."""


def clip_figures(
    after: ClipCarry, log: RunLog, rows: Array, at: Array, clock: Array, robot: Robot
) -> dict[str, float | None]:
    """How near a run came to the clip while the box was held.

    Args:
        after: What was planned.
        log: Of the run.
        rows: Its rows (n,) that count.
        at: Where the box was in these rows, seen from above (n, 2) [m].
        clock: The demonstration's time at every tick (T,) [s].
        robot: Who carried.

    Returns:
        The box's greatest distance from the clip's way [m]; the mean distance of the upper body's key points from the
        planned motion, and of neck, top of the head, elbows and wrists from the human in the robot's size, limb by limb
        (see `key_points`), both seen from the waist [mm].
    """
    if not len(rows):
        return {"off_clip_max_m": None, "upper_body_mpjpe_mm": None, "upper_body_human_mm": None}
    times, motion = clock[rows], after.carry.motion
    way = np.column_stack([np.interp(times, after.carry.knots, after.way[:, k]) for k in range(2)])
    human = human_from_waist(after.plan, robot)
    frames = np.minimum(np.round(times * after.plan.human.rate).astype(int), after.plan.human.count - 1)
    meant = [motion.sample(t).q for t in times.tolist()]
    return {
        "off_clip_max_m": float(np.linalg.norm(at - way, axis=1).max()),
        "upper_body_mpjpe_mm": _mean_mm(
            points_from_waist(robot, log.q[rows], UPPER_BODY) - points_from_waist(robot, np.array(meant), UPPER_BODY)
        ),
        "upper_body_human_mm": _mean_mm(
            points_from_waist(robot, log.q[rows], tuple(human)) - np.stack([p[frames] for p in human.values()], axis=1)
        ),
    }


def points_from_waist(robot: Robot, q: Array, names: tuple[str, ...]) -> Array:
    """Where points (T, n, 3) of a robot are at configurations (T, nq), seen from its waist [m]."""
    data, places = robot.model.createData(), np.empty((len(q), len(names), 3))
    for row, configuration in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, configuration)
        waist = data.oMf[robot.point("waist")].translation
        places[row] = [data.oMf[robot.point(name)].translation - waist for name in names]
    return places


def human_from_waist(plan: Plan, robot: Robot) -> dict[str, Array]:
    """Key points of a plan's human in the robot's size, limb by limb: point -> (T, 3) from the waist [m]."""
    human = plan.human
    directions = {segment: human.segment_direction(segment) for segment in UPPER_BODY_SEGMENTS}
    return key_points(Targets(human.points["waist"], human.frames, directions, np.zeros(human.count), {}), robot)


def _mean_mm(off: Array) -> float:
    return float(1e3 * np.linalg.norm(off, axis=2).mean())
