"""A climb over treads, up and down, one step after the other with both feet on each tread."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import GroundHeight, feet_led
from sot.motion.feet.climbing.edge_swing import CLEARANCE, edge_swing
from sot.motion.feet.climbing.terrain import EDGE_MARGIN
from sot.motion.feet.climbing.tread import check_tread
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.swing import FootPath
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.surface import FLOOR, Surface
from sot.smooth import minimum_jerk

Array = np.ndarray

KNOT_PERIOD = 0.02  # s, between knots
SWING_TIME, STANDING_TIME = 4.8, 2.4  # √(leg / g): of a step, and on both feet before the next one
WAITING_TIME = 4.8  # √(leg / g) on both feet at the start and at the end


class _Swing(NamedTuple):
    """A foot's way from one place of its frame, and from what it stood on, to others, between two times [s]."""

    foot: str
    lift: float
    land: float
    here: pin.SE3
    there: pin.SE3
    leaves: Surface
    meets: Surface


def climb(robot: Robot, treads: Sequence[Surface], rate: float = 1000.0) -> Motion:
    """The motion of a robot that climbs straight ahead, along x, over treads of the world, and ends at rest.

    The left foot goes ahead to the near end of each tread, and the right one comes after it to the far end, so that the
    way from tread to tread is as short as it can be.

    Args:
        robot: who climbs; it starts on the floor, where it is at rest.
        treads: in their order; the floor has no edges, and the foot goes as far as clears the tread before.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: there is no tread, one is too steep or too short for a sole, or legs do not reach.
    """
    if not treads:
        raise InputError("a climb needs one tread or more")
    unit, margin = float(np.sqrt(leg_length(robot) / GRAVITY)), EDGE_MARGIN * leg_length(robot)
    first, second = robot.feet
    level = planted_phases(robot, 0.0)[0].feet
    stand = dict(level)
    on = dict.fromkeys(robot.feet, FLOOR)
    now, phases = WAITING_TIME * unit, [Phase(0.0, WAITING_TIME * unit, dict(stand), surfaces=dict(on))]
    swings: list[_Swing] = []
    for tread in treads:
        near, far = _near_and_far(robot, tread, stand[second], on[second], margin)
        for foot, x in ((first, near), (second, far)):
            y = stand[foot].translation[1]
            place = np.array([x, y, tread.height_at(np.array([x, y]))])
            there = pin.SE3(pin.exp3(tread.tilt) @ level[foot].rotation, place)
            land = now + SWING_TIME * unit
            other = second if foot == first else first
            phases.append(Phase(now, land, {other: stand[other]}, surfaces={other: on[other]}))
            swings.append(_Swing(foot, now, land, stand[foot], there, on[foot], tread))
            stand[foot], on[foot] = there, tread
            last = tread is treads[-1] and foot == second
            now = land + (WAITING_TIME if last else STANDING_TIME) * unit
            phases.append(Phase(land, now, dict(stand), surfaces=dict(on)))
    times = KNOT_PERIOD * np.arange(np.ceil(now / KNOT_PERIOD) + 1)
    paths = _paths(robot, swings, times, CLEARANCE * leg_length(robot))
    return feet_led(robot, phases, paths, KNOT_PERIOD, rate, _ground_height(swings), "these treads")


def _near_and_far(robot: Robot, tread: Surface, stand: pin.SE3, on: Surface, margin: float) -> tuple[float, float]:
    """Nearest and farthest x of the feet's frames on a tread [m]; `stand` on `on` is the foot before.

    Raises:
        InputError: it is too steep, moves, or is too short for a sole.
    """
    check_tread(tread)
    flat = pin.exp3(tread.tilt) @ pin.exp3(on.tilt).T @ stand.rotation
    soles = np.vstack([robot.sole(foot) @ flat.T for foot in robot.feet])
    heel, toe = -float(soles[:, 0].min()), float(soles[:, 0].max())
    corners = tread.corners_at_point
    if not len(corners):
        edge = float(on.corners_at_point[:, 0].max()) if len(on.corners) else float(stand.translation[0])
        return edge + heel + margin, edge + heel + margin
    near, far = float(corners[:, 0].min()) + heel + margin, float(corners[:, 0].max()) - toe - margin
    aside = float(np.abs(soles[:, 1]).max()) + float(abs(stand.translation[1]))
    if far < near or min(corners[:, 1].max(), -corners[:, 1].min()) < aside:
        raise InputError(
            f"{tread.name} is too small for the soles of {robot.label}: they need {heel + toe + 2.0 * margin:.2f} m"
            f" along x and {aside:.2f} m to either side"
        )
    return near, far


def _paths(robot: Robot, swings: Sequence[_Swing], times: Array, clearance: float) -> dict[str, FootPath]:
    """Paths of the feet: up before the edge, ahead over it, and down behind it."""
    paths = {}
    for foot, start in planted_phases(robot, 0.0)[0].feet.items():
        position, tilt = np.tile(start.translation, (len(times), 1)), np.zeros((len(times), 3))
        for own, lift, land, here, there, leaves, meets in swings:
            if own != foot:
                continue
            share = (times - lift) / (land - lift)
            passed = max(float(one.corners_at_point[:, 2].max(initial=0.0)) for one in (leaves, meets))
            ahead, height = edge_swing(share, here.translation[2], there.translation[2], clearance, passed)
            way = here.translation + ahead[:, None] * (there.translation - here.translation)
            way[:, 2] = height
            position[share > 0.0] = way[share > 0.0]
            tilt += np.outer(minimum_jerk(share), meets.tilt - leaves.tilt)
        rotation = Rotation.from_rotvec(tilt).as_matrix() @ start.rotation
        paths[foot] = FootPath(position, rotation, *np.zeros((2, len(times))))
    return paths


def _ground_height(swings: Sequence[_Swing]) -> GroundHeight:
    """Mean height of what the feet stand on, each from the old one to the new one within its swing."""

    def height(times: Array, places: Array) -> Array:
        found = np.zeros(len(times))
        for one in swings:
            rise = one.there.translation[2] - one.here.translation[2]
            found += 0.5 * rise * minimum_jerk((times - one.lift) / (one.land - one.lift))
        return found

    return height
