"""How far a robot that stands on both feet can lean: its pelvis over the legs, its trunk over the pelvis."""

from functools import lru_cache

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.robots.leg_range import RANGE_MARGIN
from sot.robots.robot import Robot
from sot.robots.stance_range import Stance

Array = NDArray[np.float64]

LEAN_RESOLUTION = np.deg2rad(2.0)  # of the greatest leans
FIRST_LEAN_STEP, MAX_LEAN = np.deg2rad(15.0), np.deg2rad(60.0)  # from one lean to the next, and of those tried
UNLIMITED_LEAN = np.pi
ENDS = (-1.0, 1.0)
LOW_HIPS_LEGS = 0.83  # leg lengths, of low hips over the ankles
BALANCE_STEPS = 2  # corrections of the hips' place at each lean, until the centre of mass is over the feet again


def lean_of(axes: Array) -> Array:
    """How far and where to unit vectors (n, 3) lean from the vertical, (n, 2): an angle [rad] along X and Y."""
    flat = np.linalg.norm(axes[:, :2], axis=1)
    angle = np.arctan2(flat, axes[:, 2])
    return axes[:, :2] * (angle / np.where(flat > 0.0, flat, 1.0))[:, None]


@lru_cache
def pelvis_leans(robot: Robot) -> Array:
    """The least and greatest leans (2, 2) of the pelvis, forward and to the left, over feet as at rest [rad].

    The centre of mass stays where it is at rest, and legs as far apart as plans keep them; the hips may be lower. Where
    something else ends first, a joint's range or a leg's length, UNLIMITED_LEAN: a fit keeps to those by itself.
    LEAN_RESOLUTION at least.
    """
    return np.array(
        [[end * max(_farthest_lean(robot, end * way), LEAN_RESOLUTION) for way in np.eye(2)] for end in ENDS]
    )


@lru_cache
def trunk_leans(robot: Robot) -> Array:
    """The least and greatest leans (2, 2) of the trunk [rad], as `pelvis_leans`: those of the pelvis, and of each joint
    between waist and chest on it."""
    data, q = robot.model.createData(), robot.rest.copy()
    waist, neck = robot.point("waist"), robot.point("neck")

    def lean() -> Array:
        pin.framesForwardKinematics(robot.model, data, q)
        along = data.oMf[neck].translation - data.oMf[waist].translation
        return lean_of(along[None] / np.linalg.norm(along))[0]

    leans, upright = pelvis_leans(robot).copy(), lean()
    for joint in robot.groups["chest"]:
        ends = []
        for angle in (robot.lower[joint] + RANGE_MARGIN, robot.upper[joint] - RANGE_MARGIN):
            q[7 + joint] = angle
            ends.append(lean() - upright)
        q[7 + joint] = robot.rest[7 + joint]
        leans += [np.minimum(np.min(ends, axis=0), 0.0), np.maximum(np.max(ends, axis=0), 0.0)]
    return leans


def _farthest_lean(robot: Robot, way: Array) -> float:
    """The farthest lean of the pelvis along a way (2,), whatever height of the hips it needs [rad]."""
    stance, data = Stance(robot), robot.model.createData()
    com_at_rest = pin.centerOfMass(robot.model, data, robot.rest)[:2].copy()
    hips, ankles = (np.array([getattr(leg, place) for leg in stance.legs]) for place in ("hip", "ankle"))
    middle, length = hips.mean(axis=0), np.mean([leg.length for leg in stance.legs])

    def leaning(lean: float, place: Array, postures: list[Array]) -> tuple[Array, list[Array]] | None:
        """The hips' place and the legs' postures at a lean, looked for from others; None if legs do not do it."""
        turn = pin.exp3(lean * np.array([-way[1], way[0], 0.0]))
        for _ in range(1 + BALANCE_STEPS):
            found = stance.postures(postures, (ankles - place) @ turn - (hips - middle), [turn.T, turn.T])
            if found is None:
                return None
            postures, com = found, pin.centerOfMass(robot.model, data, stance.configuration(found))
            place = place - np.append((place + turn @ (com - middle))[:2] - com_at_rest, 0.0)
        return place, postures

    farthest = []
    for height in (middle[2], ankles[:, 2].mean() + LOW_HIPS_LEGS * length):
        done, now, step = 0.0, (np.array([*middle[:2], height]), [leg.rest for leg in stance.legs]), FIRST_LEAN_STEP
        ahead = None
        while done < MAX_LEAN and step > LEAN_RESOLUTION:
            ahead = leaning(done + step, *now)
            if ahead is None or not stance.are_apart(ahead[1]):
                step *= 0.5
            else:
                done, now = done + step, ahead
        if done >= MAX_LEAN or not stance.are_in_range(now[1]):
            return UNLIMITED_LEAN
        if ahead is not None:
            farthest.append(done)
    return max(farthest, default=UNLIMITED_LEAN)
