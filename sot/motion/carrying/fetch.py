"""A box on the floor that a robot walks to, stoops for, carries along a way and sets down: a motion without a human."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from scipy.interpolate import CubicSpline

from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.carrying.arms import palm_places
from sot.motion.carrying.carry import HELD_AHEAD, HELD_HEIGHT, STANDOFF, CarryPlan
from sot.motion.carrying.handling_times import CLOSING_TIME, KNOT_PERIOD, REACHING_TIME, HandlingTimes
from sot.motion.carrying.stoop import Stoop, StoopedArms, stooped_way
from sot.motion.feet.footwork import Foothold
from sot.motion.trajectory import Motion
from sot.motion.way import footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = np.ndarray

STOOP_LOWERED, STOOP_PITCH = 0.17, 0.6  # leg lengths and rad, of a body whose hands take a box from the floor
HANDS_PITCH = 0.6  # rad, by which the fingers point down: between a box on the floor and one before the chest
GRIP_BELOW_TOP = 0.08  # leg lengths, of the palms' middle
RAISING_TIME = 12.0  # √(leg / g), of lifting a box from the floor to before the chest
LIFTING_POSTURES = 13


def box_ahead(robot: Robot) -> float:
    """How far ahead of its body a robot has a box that it takes or holds [m]."""
    return HELD_AHEAD * leg_length(robot)


def fetch(
    robot: Robot,
    size: tuple[float, float, float],
    mass: float,
    approach: Sequence[Foothold],
    way: Sequence[Foothold],
    rate: float = 1000.0,
) -> CarryPlan:
    """The motion of a robot that walks to a box on the floor, takes it, carries it to another place, and sets it down.

    Args:
        robot: who carries; it has surfaces "left_palm" and "right_palm".
        size: of the box, ahead, to the side, where the palms are, and up, as the robot before it sees it [m].
        mass: of the box [kg].
        approach: stops of the body, see `footsteps_along`, at the last of which the box is `box_ahead`.
        way: stops of the body with the box.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: arms or legs do not reach.
    """
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    taking = REACHING_TIME + CLOSING_TIME + RAISING_TIME + 2.0
    walked = footsteps_along(robot, [*approach, *way], waits={len(approach) - 1: taking + 1.0})
    begin = walked.arrivals[len(approach) - 1] + unit
    times = HandlingTimes.of(begin, walked.arrivals[-1] + unit, RAISING_TIME, unit)
    knots = times.knots()
    grip = 0.5 * size[2] - GRIP_BELOW_TOP * leg
    lifting = _Lifting(robot, size, grip)
    arms = robot.joint_numbers("arms")
    reach, close = times.reach_share(knots), times.close_share(knots)
    held, low, pitch, before = lifting.at(times.raised_share(knots))
    rest = robot.rest[7 + arms]
    angles = rest + reach[:, None] * (lifting.beside - rest) + close[:, None] * (held - lifting.beside)
    kept = np.setdiff1d(np.arange(robot.na), robot.joint_numbers("legs"))
    upper = np.tile(robot.rest[7 + kept], (len(knots), 1))
    upper[:, np.searchsorted(kept, arms)] = angles
    carried = times.carried_share(knots, times.lifted + CLOSING_TIME * unit)
    load = HeldLoad(kept, upper, mass * carried, "chest", before, lowered=reach * low, pitch=reach * pitch)
    phases, paths = walked.feet_at(robot, knots)
    motion = feet_led(robot, phases, paths, KNOT_PERIOD, rate, where="its way", load=load)
    box = _box_path(motion, load, knots, times.lifted, times.placed, 0.5 * size[2])
    hands = palm_places(robot, size[1], HANDS_PITCH, np.array([0.0, 0.0, grip]))
    return CarryPlan.of(motion, box, knots, times, hands, size)


class _Lifting:
    """How a robot holds a box from the floor to before its chest.

    Args:
        robot: who lifts.
        size: of the box (3,) [m].
        grip: of the palms above the box's middle [m].

    Attributes:
        beside: angles of the arms (k,) whose palms are beside the box on the floor.
    """

    def __init__(self, robot: Robot, size: tuple[float, float, float], grip: float) -> None:
        leg, solver = leg_length(robot), StoopedArms(robot)
        data, arms = robot.model.createData(), robot.joint_numbers("arms")
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        top = float(data.oMf[robot.point("waist")].translation[2]) + HELD_HEIGHT * leg
        bottom, ahead = 0.5 * size[2] + grip, box_ahead(robot)
        self._shares = np.linspace(0.0, 1.0, LIFTING_POSTURES)
        stoops = [Stoop((1.0 - s) * STOOP_LOWERED * leg, (1.0 - s) * STOOP_PITCH) for s in self._shares]

        def palms(share: float, gap: float = 0.0) -> dict[str, pin.SE3]:
            middle = np.array([ahead, 0.0, bottom + share * (top - bottom)])
            return palm_places(robot, size[1] + 2.0 * gap, HANDS_PITCH, middle)

        q = stooped_way(solver, [palms(s) for s in self._shares[::-1]], stoops[::-1])[::-1]
        self.beside = solver.reaching(palms(0.0, STANDOFF * leg), stoops[0], q[0])[7 + arms]
        before = []
        for row, s in zip(q, self._shares, strict=True):
            pin.framesForwardKinematics(robot.model, data, row)
            middle = np.array([ahead, 0.0, bottom + s * (top - bottom) - grip])
            before.append(data.oMf[robot.point("chest")].actInv(middle))
        self._postures = np.hstack(
            [q[:, 7 + arms], [[stoop.lowered, stoop.pitch] for stoop in stoops], np.array(before)]
        )

    def at(self, shares: Array) -> tuple[Array, Array, Array, Array]:
        """Angles of the arms (T, k), how much the body is lowered (T,) and pitched (T,), and the box in the chest's
        axes (T, 3), at shares of the lifting (T,)."""
        columns = CubicSpline(self._shares, self._postures)(shares)
        return columns[:, :-5], columns[:, -5], columns[:, -4], columns[:, -3:]


def _box_path(motion: Motion, load: HeldLoad, knots: Array, lifted: float, placed: float, low: float) -> list[pin.SE3]:
    """Where the box is at the knots: upright before the chest while it is carried, else where it stands on the floor.

    low: height of its middle there [m].
    """
    chest, found = motion.pose("chest"), []
    for t in np.clip(knots, lifted, placed):
        pose, k = chest(float(t)), min(int(np.searchsorted(knots, t - 1e-9)), len(knots) - 1)
        left = pose.rotation[:, 1]  # level, however far the trunk is pitched
        place = pose.position + pose.rotation @ load.place[k]
        if t in (lifted, placed):
            place[2] = low
        found.append(pin.SE3(pin.utils.rotate("z", float(np.arctan2(-left[0], left[1]))), place))
    return found
