"""The table, the bag on it, and where hands, foot and centre of mass are to be, in the robot's size."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.system import System
from sot.robots.things.thing import Thing
from sot.static_region import Patch, static_region

Array = np.ndarray

# In leg lengths, from the middle of the feet.
TABLE_HEIGHT, TABLE_FRONT, TABLE_SIZE = 1.415, 0.70, (0.9, 1.6)
PALM_PLACE = (0.835, -0.466)
BAG_PLACE = (1.10, 0.20)
HOME = (0.60, 0.33, 1.80)  # of the left hand's point, with the bag
LEAN_BEYOND = 0.035  # of the centre of mass, beyond the sole's front
REGION_MARGIN = 0.03  # of the centre of mass from the edge of the static region
LEAN_RAD, WAIST_SHARE = 0.32, 0.6  # of the chest, and the waist's share of it
WAIST_LOWERED = 0.03

PALM_DOWN = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Axes of the right hand that points forward, its palm down."""
HOOKING = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Axes of the left hand that points forward, its hook up."""

PALM_FRICTION = 0.35
"""Coefficient that is relied upon between the palm and the table: half of what tables are told to have."""
PALM_LEAST, PALM_MOST = 0.03, 0.45
"""Bounds of the normal force of the hand that supports, in weights of the robot."""


def bag_things(robot: Robot, mass: float, offset: pin.SE3 | None = None, lower: float = 0.0) -> list[Thing]:
    """The table, and the bag on it.

    Args:
        robot: In whose size.
        mass: Of the bag [kg].
        offset: By how much the bag is off its place, in its own axes.
        lower: By how much the table is lower than it should be [m].
    """
    leg = leg_length(robot)
    depth, width = (leg * side for side in TABLE_SIZE)
    top = leg * TABLE_HEIGHT - lower
    table = Thing.load("table", placement=(leg * TABLE_FRONT + 0.5 * depth, 0.0, 0.0), size=(depth, width, top))
    place = pin.SE3(np.eye(3), np.array([leg * BAG_PLACE[0], leg * BAG_PLACE[1], top]))
    return [table, Thing.load("bag", placement=place * (offset or pin.SE3.Identity()), mass=mass)]


@dataclass(frozen=True)
class BagPlan:
    """Where all is to be.

    Attributes:
        palm: Of the right hand's point when its palm is on the table.
        hook: Of the left hand's point when its hook touches the handle from below.
        home: Of the left hand's point at the end.
        over_foot, leaning, middle: Of the centre of mass over the right foot, beyond its sole, and over both [m].
        sole_edge: Front of the right sole along x [m].
        trunk: Point -> leaning placement, of waist and chest.
        start: Point -> placement at rest.
    """

    palm: pin.SE3
    hook: pin.SE3
    home: pin.SE3
    over_foot: Array
    leaning: Array
    middle: Array
    sole_edge: float
    trunk: dict[str, pin.SE3]
    start: dict[str, pin.SE3]

    @staticmethod
    def of(system: System) -> "BagPlan":
        """The plan for a robot and the scene that it is told.

        Raises:
            InputError: The robot lacks a surface, or the supports cannot hold a centre of mass beyond the sole.
        """
        robot, leg = system.robot, leg_length(system.robot)
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        points = ("left_hand", "right_hand", "left_foot", "right_foot", "waist", "chest")
        start = {point: data.oMf[robot.point(point)].copy() for point in points}
        table = system.surface("table/top")
        handle = pin.XYZQUATToSE3(system.rest[system.coordinates["bag"]]) * system.surface("bag/handle").placement
        palm = _surface_at(robot, "right_palm", PALM_DOWN, [*(leg * k for k in PALM_PLACE), table.axes.translation[2]])
        hook = _surface_at(robot, "left_hook", HOOKING, handle.translation)
        sole = np.array([start["right_foot"].act(corner) for corner in robot.sole("right_foot")])
        edge = float(sole[:, 0].max())
        patches = [
            Patch(sole, np.eye(3), robot.surface("right_foot").friction),
            Patch(
                np.array([palm.act(corner) for corner in robot.surface("right_palm").corners_at_point]),
                np.eye(3),
                PALM_FRICTION,
                PALM_MOST * robot.mass * GRAVITY,
            ),
        ]
        region = static_region(patches, robot.mass * GRAVITY)
        over_foot = sole[:, :2].mean(axis=0)
        forward = palm.translation[:2] - over_foot
        leaning = over_foot + (edge + LEAN_BEYOND * leg - over_foot[0]) / forward[0] * forward
        if float(region.margin(leaning)) < REGION_MARGIN * leg:
            raise InputError(
                f"{robot.label} cannot lean that far beyond its sole: the hand would have to bear too much"
            )
        return BagPlan(
            palm=palm,
            hook=hook,
            home=pin.SE3(HOOKING, leg * np.array(HOME)),
            over_foot=over_foot,
            leaning=leaning,
            middle=pin.centerOfMass(robot.model, data, robot.rest)[:2].copy(),
            sole_edge=edge,
            trunk={
                "waist": _leaning(start["waist"], WAIST_SHARE * LEAN_RAD, WAIST_LOWERED * leg),
                "chest": _leaning(start["chest"], LEAN_RAD, 0.0),
            },
            start=start,
        )


def _surface_at(robot: Robot, surface: str, rotation: Array, place: Array | list[float]) -> pin.SE3:
    """Where a hand's point is when its surface's middle is at a place (3,)."""
    return pin.SE3(rotation, np.array(place) - rotation @ robot.surface(surface).axes.translation)


def _leaning(place: pin.SE3, angle: float, lowered: float) -> pin.SE3:
    turn = pin.exp3(np.array([0.0, angle, 0.0]))
    return pin.SE3(turn @ place.rotation, place.translation - [0.0, 0.0, lowered])
