"""A box taken from a stand, carried along a way on the robot's own steps, and set down: a motion without a human."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.swing import contact_phases, foot_paths
from sot.motion.trajectory import Motion
from sot.motion.way import STEP_HEIGHT, footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.smooth import minimum_jerk

Array = np.ndarray

KNOT_PERIOD = 0.02  # s, between knots
HELD_AHEAD, HELD_HEIGHT = 0.62, 0.3  # leg lengths, of the box's middle from the waist, ahead and up, while it is held
LIFT = 0.12  # leg lengths, from where the box lies to where it is carried
HANDS_PITCH = 0.3  # rad, by which the fingers point down
STANDOFF = 0.16  # leg lengths, of the palms from the box before they touch it and when they have let go
REACHING_TIME, LIFTING_TIME = 8.0, 6.0  # √(leg / g): of the arms from rest to beside the box, and of lifting it
CLOSING_TIME = 2.0  # √(leg / g), of the arms from beside the box to it
MAX_ARM_WAY = 0.1  # m and rad, of a hand, before its arm is solved for anew
ARM_STEPS = 30  # Newton steps of the arms' inverse kinematics, at most
DAMPING = 1e-5  # of these steps, beside squared lengths [m²]
ARM_TOLERANCE, ROUNDING = 1e-3, 1e-9  # m and rad
ORIGIN = np.zeros(3)


@dataclass(frozen=True)
class CarryPlan:
    """A motion with a box, and when it is what.

    Attributes:
        motion: of the robot; centre of mass, momentum and ZMP count the box while it is carried.
        box: its place at times `knots` (T,), in the world; where it lies before and after.
        knots: [s].
        gripped, lifted, placed, released: when hands take it, it leaves its stand, is set down, and hands let go [s].
        arrived: when the walk is over, and the box is lowered [s].
        hands: hand -> its place in the box's axes while it holds it.
        size: of the box, ahead, to the side and up [m].
    """

    motion: Motion
    box: Sequence[pin.SE3]
    knots: Array
    gripped: float
    lifted: float
    arrived: float
    placed: float
    released: float
    hands: dict[str, pin.SE3]
    size: tuple[float, float, float]


def carry(
    robot: Robot, size: tuple[float, float, float], mass: float, stops: Sequence[Foothold], rate: float = 1000.0
) -> CarryPlan:
    """The motion of a robot that takes a box from where it stands, carries it from stop to stop, and sets it down.

    The arms hold the box before the chest and stay as they are while the robot walks.

    Args:
        robot: who carries; it has surfaces "left_palm" and "right_palm".
        size: of the box, ahead, to the side, where the palms are, and up [m].
        mass: of the box [kg].
        stops: of the body, see `footsteps_along`.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: arms or legs do not reach.
    """
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    gripped = (REACHING_TIME + 1.0) * unit
    lifted = gripped + CLOSING_TIME * unit
    raised = lifted + LIFTING_TIME * unit
    walked = footsteps_along(robot, stops, raised + unit)
    arrived = walked.end
    placed = arrived + LIFTING_TIME * unit
    opening = placed + CLOSING_TIME * unit
    released = opening + CLOSING_TIME * unit
    end = released + (REACHING_TIME + 1.0) * unit
    knots = KNOT_PERIOD * np.arange(np.ceil(end / KNOT_PERIOD) + 1)

    def share(start: float, end: float) -> Array:
        return np.asarray(minimum_jerk((knots - start) / (end - start)))

    arms = _Arms(robot, size[1])
    kept = np.setdiff1d(np.arange(robot.na), robot.joint_numbers("legs"))
    height = HELD_HEIGHT * leg - LIFT * leg * (1.0 - share(lifted, raised) + share(arrived, placed))
    low, held = arms.holding(HELD_AHEAD * leg, height[0], 0.0), np.empty((len(knots), len(arms.joints)))
    for k, own in enumerate(height):
        again = k and own == height[k - 1]
        held[k] = held[k - 1] if again else arms.holding(HELD_AHEAD * leg, own, 0.0, low if not k else held[k - 1])
    beside = arms.holding(HELD_AHEAD * leg, height[0], STANDOFF * leg, low)
    rest = robot.rest[7 + arms.joints]
    reach = share(unit, gripped) - share(released, end - unit)
    close = share(gripped, lifted) - share(opening, released)
    angles = rest + reach[:, None] * (beside - rest) + close[:, None] * (held - beside)
    carried = share(lifted, raised) - share(placed, opening)
    before = np.tile([HELD_AHEAD * leg, 0.0, 0.0], (len(knots), 1))
    before[:, 2] = height
    upper = np.tile(robot.rest[7 + kept], (len(knots), 1))
    upper[:, np.searchsorted(kept, arms.joints)] = angles
    load = HeldLoad(kept, upper, mass * carried, "chest", before - arms.chest)
    paths = foot_paths(
        robot, walked.stands, walked.steps, [STEP_HEIGHT * leg] * len(walked.steps), LegReach.of(robot), knots
    )
    phases = contact_phases(robot, walked.stands, walked.steps, float(knots[-1]))
    motion = feet_led(robot, phases, paths, KNOT_PERIOD, rate, where="its way", load=load)
    box = _box_path(motion, load, knots, lifted, placed)
    return CarryPlan(
        motion, box, knots, gripped, lifted, arrived, placed, released, palm_places(robot, size[1], HANDS_PITCH), size
    )


def palm_places(robot: Robot, width: float, pitch: float, middle: Array = ORIGIN) -> dict[str, pin.SE3]:
    """Places of the frames of hands whose palms face each other, level, in axes of which x points ahead and z up.

    Args:
        robot: whose hands they are.
        width: between the palms [m].
        pitch: by which the fingers point down [rad].
        middle: between the palms (3,) [m].
    """
    places = {}
    fingers = np.array([np.cos(pitch), 0.0, -np.sin(pitch)])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        palm, tip = robot.surface(f"{side}_palm"), robot.surface(f"{side}_hand_end")
        assert palm.point is not None
        inward, own, end = np.array([0.0, -sign, 0.0]), palm.placement.rotation[:, 2], tip.placement.rotation[:, 2]
        turn = np.column_stack([inward, fingers, np.cross(inward, fingers)])
        turn = turn @ np.column_stack([own, end, np.cross(own, end)]).T
        touch = middle - 0.5 * width * inward
        places[palm.point] = pin.SE3(turn, touch - turn @ palm.placement.translation)
    return places


def _box_path(motion: Motion, load: HeldLoad, knots: Array, lifted: float, placed: float) -> list[pin.SE3]:
    """Where the box is at the knots: before the chest while it is carried, else where it lies."""
    chest = motion.pose(load.point)
    found = []
    for t in np.clip(knots, lifted, placed):
        pose, k = chest(float(t)), int(np.searchsorted(knots, t))
        upright = pose.rotation @ chest(0.0).rotation.T
        place = pose.position + pose.rotation @ load.place[min(k, len(knots) - 1)]
        found.append(pin.SE3(upright, place))
    return found


class _Arms:
    """Inverse kinematics of arms that hold a box before a robot at rest; places count from the waist."""

    def __init__(self, robot: Robot, width: float) -> None:
        self._robot, self._width = robot, width
        self._data = robot.model.createData()
        self.joints = robot.joint_numbers("arms")
        pin.framesForwardKinematics(robot.model, self._data, robot.rest)
        self._waist = self._data.oMf[robot.point("waist")].translation.copy()
        self.chest = self._data.oMf[robot.point("chest")].translation - self._waist

    def holding(self, ahead: float, height: float, gap: float, start: Array | None = None) -> Array:
        """Angles of the arms' joints (k,) whose palms are flat beside a box, or a gap [m] off it.

        Args:
            ahead, height: of the box's middle from the waist [m].
            gap: between palms and box [m].
            start: angles from which the arms go there; at rest unless given.

        Raises:
            InputError: arms do not reach.
        """
        robot, q = self._robot, self._robot.rest.copy()
        if start is not None:
            q[7 + self.joints] = start
        pin.framesForwardKinematics(robot.model, self._data, q)
        goals = palm_places(robot, self._width + 2.0 * gap, HANDS_PITCH, np.array([ahead, 0.0, height]))
        begin = {point: self._data.oMf[robot.point(point)].copy() for point in goals}
        ways = {point: pin.log6(begin[point].actInv(self._in_world(goal))) for point, goal in goals.items()}
        longest = max(float(np.abs(way.vector).max()) for way in ways.values())
        count = max(int(np.ceil(longest / MAX_ARM_WAY)), 1)
        for k in range(count):
            error = np.inf
            aims = {point: begin[point] * pin.exp6(way * ((k + 1) / count)) for point, way in ways.items()}
            for _ in range(ARM_STEPS):
                q, error = self._nearer(q, aims)
                if error < ROUNDING:
                    break
        if error > ARM_TOLERANCE:
            raise InputError(
                f"{robot.label} cannot hold a box {self._width:.2f} m wide like that: its arms do not reach"
            )
        return q[7 + self.joints]

    def _in_world(self, place: pin.SE3) -> pin.SE3:
        return pin.SE3(place.rotation, place.translation + self._waist)

    def _nearer(self, q: Array, aims: dict[str, pin.SE3]) -> tuple[Array, float]:
        """A Newton step of the arms towards places of the hands, within the joints' ranges; and the error before it."""
        robot, data = self._robot, self._data
        pin.computeJointJacobians(robot.model, data, q)
        pin.updateFramePlacements(robot.model, data)
        rows, errors = [], []
        for point, aim in aims.items():
            frame = robot.point(point)
            rows.append(pin.getFrameJacobian(robot.model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:, 6 + self.joints])
            errors += [
                aim.translation - data.oMf[frame].translation,
                pin.log3(aim.rotation @ data.oMf[frame].rotation.T),
            ]
        error = np.concatenate(errors)
        J, step = np.vstack(rows), np.zeros(robot.nv)
        step[6 + self.joints] = J.T @ np.linalg.solve(J @ J.T + DAMPING * np.eye(len(J)), error)
        nearer = pin.integrate(robot.model, q, step)
        nearer[7:] = np.clip(nearer[7:], robot.lower, robot.upper)
        return nearer, float(np.abs(error).max())
