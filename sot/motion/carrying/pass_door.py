"""A door with a lever that a robot unlatches, pushes open and walks through behind it: a motion without a human."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import convolve1d
from scipy.spatial.transform import Rotation, Slerp

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.carrying.arms import fist_places
from sot.motion.carrying.stoop import Stoop, StoopedArms
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.swing import FootPath, feet_heading, feet_middle
from sot.motion.objects.pose_path import PosePath, blended
from sot.motion.trajectory import Motion
from sot.motion.way import STANDING_TIME, SWING_TIME, footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.smooth import minimum_jerk

Array = np.ndarray

KNOT_PERIOD = 0.02  # s, between knots
# In leg lengths.
FIST_HEIGHT = 1.25  # of the hands' ends on the leaf
PARKED = (0.40, 0.42, 1.25)  # of the other hand's end from the body, ahead, aside and up, while the robot walks
RAISED = (0.33, -0.46, 1.72)  # of the pressing hand's end from the body, before it goes above the lever
BACK = 0.33  # of the pressing hand from above the lever, before it goes down to the leaf
ABOVE = 0.24  # of the palm from the lever before it presses, and when it has
STANDOFF = 0.16  # of a hand from what it touches
HELPING_ASIDE = 0.335  # of the other hand's end from the body's middle, while it pushes until the bolt is past
# Where the pushing hand's end is from the body, by the angle of the door: first the body keeps clear of the frame.
ANGLES = (0.0, 0.35, 0.6, 1.2)  # rad
AHEAD, ASIDE = (0.61, 0.65, 0.68, 0.595), (0.42, 0.47, 0.58, 0.257)
HEADING_SHARE = 0.6  # of the door's angle, that the body turns
MOVING_TIME, CLOSING_TIME, PRESSING_TIME, OPENING_TIME = 7.0, 4.0, 8.0, 16.0  # √(leg / g)
UNLATCHING_TIME = 3.0 * MOVING_TIME + 3.0 * CLOSING_TIME + PRESSING_TIME + OPENING_TIME
HANDING_TIME = 2.0 * MOVING_TIME + 2.0 * CLOSING_TIME
POSTURE_PERIOD = 0.3  # s, between postures of the arms
STOPS = 4  # of the body between where it stands before the door and where it ends


@dataclass(frozen=True)
class DoorLayout:
    """A door as a robot at the origin sees it: the hinge on the left, and it opens away.

    Attributes:
        hinge: place of its axis (2,) [m].
        face: distance of the leaf's near face from the axis, towards the robot [m].
        bar: middle of the part of the lever's bar that is pressed (3,), on top of it [m].
        grip: distance from the axis, along the leaf, at which it is pushed [m].
        stiffness: spring of the hinge [N m/rad].
        press_force: on the palm when the lever is down [N].
        press: way of the bar down until the bolt is back [m].
        unlatched: angle at which the bolt is past the frame [rad].
        opened: angle to which it is opened [rad].
    """

    hinge: Array
    face: float
    bar: Array
    grip: float
    stiffness: float
    press_force: float
    press: float
    unlatched: float
    opened: float

    def leaf(self, angle: float) -> pin.SE3:
        """Placement of the leaf, relative to where it is closed."""
        turn = pin.utils.rotate("z", angle)
        axis = np.array([*self.hinge, 0.0])
        return pin.SE3(turn, axis - turn @ axis)

    def on_face(self, along: float, height: float) -> Array:
        """A point of the closed leaf's near face (3,), at a distance from the axis and a height [m]."""
        return np.array([self.hinge[0] - self.face, self.hinge[1] - along, height])

    def body(self, angle: float, leg: float) -> Foothold:
        """Where the body is while the pushing hand is on the leaf."""
        place = self.leaf(angle).act(self.on_face(self.grip, 0.0))
        heading = HEADING_SHARE * angle
        off = leg * np.array([np.interp(angle, ANGLES, AHEAD), -np.interp(angle, ANGLES, ASIDE), 0.0])
        x, y, _ = place - pin.utils.rotate("z", heading) @ off
        return Foothold(float(x), float(y), heading)


@dataclass(frozen=True)
class DoorPlan:
    """A motion through a door.

    Attributes:
        motion: of the robot; its ZMP counts the push.
        hands: hand -> its path in the world.
        knots: times (T,) [s].
        angle: of the door at these times (T,) [rad].
        forces: hand -> force on it at these times (T, 3), world axes [N].
        opened: when the walk is over [s].
    """

    motion: Motion
    hands: dict[str, PosePath]
    knots: Array
    angle: Array
    forces: dict[str, Array]
    opened: float


def pass_door(robot: Robot, door: DoorLayout, rate: float = 1000.0) -> DoorPlan:
    """The motion of a robot that opens a door and walks through.

    It steps up to the door, presses the lever with the right palm, pushes the leaf with the end of the left hand until
    the bolt is past the frame, and then with the end of the right hand while it walks.

    Args:
        robot: who passes.
        door: what it passes.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: arms or legs do not reach.
    """
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    before = door.body(0.0, leg)
    angles = np.linspace(door.unlatched, door.opened, STOPS)
    stops = [before, *(door.body(float(angle), leg) for angle in angles)]
    waits = {0: UNLATCHING_TIME + 2.0, 1: HANDING_TIME + 2.0} | dict.fromkeys(range(2, STOPS), STANDING_TIME)
    walked = footsteps_along(robot, stops, waits=waits)
    times = _Times(walked.arrivals[0], walked.arrivals[1], unit)
    end = walked.end
    knots = KNOT_PERIOD * np.arange(np.ceil(end / KNOT_PERIOD) + 1)
    phases, paths = walked.feet_at(robot, knots)
    window = 2.0 * (SWING_TIME + STANDING_TIME) * unit
    body = _body(paths, window)
    share = minimum_jerk((knots - times.pressed) / (times.opened - times.pressed))
    angle = door.unlatched * share + _walked_angle(door, leg, body, knots > times.handed, window)
    down = minimum_jerk((knots - times.touched) / (times.pressed - times.touched))
    tips = {
        "right_hand": robot.surface("right_hand_end").placement.translation,
        "left_hand": robot.surface("left_hand_end").placement.translation,
    }
    tracks = _hand_tracks(robot, door, leg, times, knots, body, angle, down)
    forces = _forces(door, leg, before, times, knots, angle, down)
    touching = ((knots > times.near) & (knots < times.off_bar)) | (knots > times.before_leaf)
    posture, tracks = _postures(robot, tracks, tips, body, knots, touching)
    kept = np.setdiff1d(np.arange(robot.na), robot.joint_numbers("legs"))
    upper = np.tile(robot.rest[7 + kept], (len(knots), 1))
    upper[:, np.searchsorted(kept, robot.joint_numbers("arms"))] = posture
    place = np.tile(leg * np.array([AHEAD[0], 0.0, FIST_HEIGHT]) - _chest(robot), (len(knots), 1))
    level = np.sum([force * [1.0, 1.0, 0.0] for force in forces.values()], axis=0)
    load = HeldLoad(kept, upper, np.zeros(len(knots)), "chest", place, level)
    motion = feet_led(robot, phases, paths, KNOT_PERIOD, rate, where="its way", load=load)
    hands = {hand: PosePath.through(knots, position, rotation, rate) for hand, (position, rotation) in tracks.items()}
    return DoorPlan(motion, hands, knots, angle, forces, walked.arrivals[-1])


class _Times:
    """When what is done before the walk through the door."""

    def __init__(self, arrived: float, behind: float, unit: float) -> None:
        self.begin = arrived + unit
        self.raised = self.begin + MOVING_TIME * unit
        self.near = self.raised + MOVING_TIME * unit
        self.touched = self.near + CLOSING_TIME * unit
        self.pressed = self.touched + PRESSING_TIME * unit
        self.opened = self.pressed + OPENING_TIME * unit
        self.off_bar = self.opened + CLOSING_TIME * unit
        self.back = self.off_bar + CLOSING_TIME * unit
        self.tucked = self.back + MOVING_TIME * unit
        self.following = behind + unit
        self.before_leaf = self.following + MOVING_TIME * unit
        self.on_leaf = self.before_leaf + CLOSING_TIME * unit
        self.handed = self.on_leaf + CLOSING_TIME * unit
        self.parked = self.handed + MOVING_TIME * unit


def _body(paths: dict[str, FootPath], window: float) -> Array:
    """Place and heading of the body (T, 3), without its steps."""
    way = np.column_stack([feet_middle(paths), feet_heading(paths)])
    way[:, :2] -= way[0, :2]
    return _smoothed(way, window)


def _smoothed(values: Array, window: float) -> Array:
    count = 2 * round(0.5 * window / KNOT_PERIOD) + 1
    weights = np.hanning(count + 2)[1:-1]
    smooth: Array = convolve1d(values, weights / weights.sum(), axis=0, mode="nearest")
    return smooth


def _walked_angle(door: DoorLayout, leg: float, body: Array, walking: Array, window: float) -> Array:
    """By how much the door is further open than unlatched (T,): as far as the body has come [rad]."""
    grid = np.linspace(door.unlatched, door.opened, 400)
    places = np.array([[one.x, one.y] for one in (door.body(float(angle), leg) for angle in grid)])
    nearest = np.linalg.norm(body[:, None, :2] - places, axis=2).argmin(axis=1)
    found = np.where(walking, grid[nearest] - door.unlatched, 0.0)
    return _smoothed(np.maximum.accumulate(found), 0.5 * window)


def _hand_tracks(
    robot: Robot, door: DoorLayout, leg: float, times: _Times, knots: Array, body: Array, angle: Array, down: Array
) -> dict[str, tuple[Array, Array]]:
    """Places (T, 3) and axes (T, 3, 3) of both hands' frames in the world."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    rest = {f"{side}_hand": data.oMf[robot.point(f"{side}_hand")].copy() for side in ("left", "right")}
    bodies = [pin.SE3(pin.utils.rotate("z", h), np.array([x, y, 0.0])) for x, y, h in body]
    leaves = [door.leaf(a) for a in angle.tolist()]
    before = door.body(0.0, leg)

    def fist(side: str, tip: Array, yaw: float = 0.0) -> pin.SE3:
        turn = pin.utils.rotate("z", yaw) @ fist_places(robot, 0.0, np.zeros(3))[f"{side}_hand"].rotation
        return pin.SE3(turn, tip - turn @ robot.surface(f"{side}_hand_end").placement.translation)

    def with_body(place: pin.SE3) -> list[pin.SE3]:
        return [one * place for one in bodies]

    def with_leaf(place: pin.SE3) -> list[pin.SE3]:
        return [one * place for one in leaves]

    def fixed(place: pin.SE3) -> list[pin.SE3]:
        return [place] * len(knots)

    def shifted(place: pin.SE3, *shift: float) -> pin.SE3:
        return pin.SE3(place.rotation, place.translation + leg * np.array(shift))

    # Palm down: fingers ahead, the palm's face below.
    palm, tip = robot.surface("right_palm"), robot.surface("right_hand_end")
    own, end = palm.placement.rotation[:, 2], tip.placement.rotation[:, 2]
    face, fingers = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    turn = np.column_stack([face, fingers, np.cross(face, fingers)])
    turn = turn @ np.column_stack([own, end, np.cross(own, end)]).T
    on_bar = pin.SE3(turn, door.bar - turn @ palm.placement.translation)
    pressing = [
        pin.SE3(turn, leaf.act(door.bar - [0.0, 0.0, door.press * share]) - turn @ palm.placement.translation)
        for leaf, share in zip(leaves, down.tolist(), strict=True)
    ]
    pressed = [pin.SE3(turn, p.translation) for p in pressing]
    above = [shifted(place, 0.0, 0.0, ABOVE + door.press / leg) for place in pressed]
    away = [shifted(place, -BACK, 0.0, 0.0) for place in above]
    pushing = fist("right", door.on_face(door.grip, FIST_HEIGHT * leg))
    helped = before.y + HELPING_ASIDE * leg
    helping = fist("left", door.on_face(float(door.hinge[1] - helped), FIST_HEIGHT * leg))
    parked = fist("left", leg * np.array(PARKED))
    tucked = fist("right", leg * np.array([PARKED[0], -PARKED[1], PARKED[2]]))
    raised = fist("right", leg * np.array(RAISED))
    right = [
        (times.begin, with_body(rest["right_hand"])),
        (times.raised, with_body(raised)),
        (times.near, fixed(shifted(on_bar, 0.0, 0.0, ABOVE))),
        (times.touched, pressing),
        (times.opened, pressing),
        (times.off_bar, above),
        (times.back, away),
        (times.tucked, with_body(tucked)),
        (times.following, with_body(tucked)),
        (times.before_leaf, with_leaf(shifted(pushing, -STANDOFF, 0.0, 0.0))),
        (times.on_leaf, with_leaf(pushing)),
    ]
    left = [
        (times.begin, with_body(rest["left_hand"])),
        (times.raised, with_body(parked)),
        (times.near, fixed(shifted(helping, -STANDOFF, 0.0, 0.0))),
        (times.touched, with_leaf(helping)),
        (times.handed, with_leaf(helping)),
        (times.parked, with_body(parked)),
    ]
    return {"right_hand": _track(knots, right), "left_hand": _track(knots, left)}


def _track(knots: Array, keys: list[tuple[float, list[pin.SE3]]]) -> tuple[Array, Array]:
    """What goes from one moving place to the next, at each from its time on until it leaves for the next one."""
    places = keys[0][1]
    for (start, _), (end, goals) in pairwise(keys):
        position, rotation = blended(places, goals, minimum_jerk((knots - start) / (end - start)))
        places = [pin.SE3(turn, place) for turn, place in zip(rotation, position, strict=True)]
    return np.array([place.translation for place in places]), np.array([place.rotation for place in places])


def _forces(
    door: DoorLayout, leg: float, before: Foothold, times: _Times, knots: Array, angle: Array, down: Array
) -> dict[str, Array]:
    """Forces (T, 3) on the hands: of the leaf's spring, and of the lever's."""
    normal = -np.column_stack([np.cos(angle), np.sin(angle), np.zeros(len(knots))])
    moment = door.stiffness * angle
    helped = float(door.hinge[1]) - before.y - HELPING_ASIDE * leg
    handed = minimum_jerk((knots - times.on_leaf) / (times.handed - times.on_leaf))
    lift = down * (1.0 - minimum_jerk((knots - times.opened) / (times.off_bar - times.opened)))
    right = (handed * moment / door.grip)[:, None] * normal
    right[:, 2] = door.press_force * lift
    return {"left_hand": ((1.0 - handed) * moment / helped)[:, None] * normal, "right_hand": right}


def _postures(
    robot: Robot,
    tracks: dict[str, tuple[Array, Array]],
    tips: dict[str, Array],
    body: Array,
    knots: Array,
    touching: NDArray[np.bool_],
) -> tuple[Array, dict[str, tuple[Array, Array]]]:
    """Angles of the arms (T, k), and the tracks of the hands as far as the arms can follow.

    Axes give way where arms cannot turn that far. On their way through the air arms that do not reach stay as they are.

    Raises:
        InputError: hands that touch (T,) do not reach.
    """
    solver, arms = StoopedArms(robot), robot.joint_numbers("arms")
    data, every = robot.model.createData(), max(round(POSTURE_PERIOD / KNOT_PERIOD), 1)
    rows = np.unique([*range(0, len(knots), every), len(knots) - 1])
    found, q = [], robot.rest
    turns, shifts = ({hand: list[Array]() for hand in tracks} for _ in range(2))
    for k in rows:
        x, y, heading = body[k]
        world = pin.SE3(pin.utils.rotate("z", float(heading)), np.array([x, y, 0.0]))
        goals = {hand: world.actInv(pin.SE3(turn[k], place[k])) for hand, (place, turn) in tracks.items()}
        try:
            q = solver.reaching(goals, Stoop(), q, tips)
        except InputError:
            if touching[k]:
                raise
        found.append(q[7 + arms])
        pin.framesForwardKinematics(robot.model, data, q)
        for hand, goal in goals.items():
            own = data.oMf[robot.point(hand)]
            turns[hand].append(world.rotation @ own.rotation)
            shifts[hand].append(world.rotation @ (own.act(tips[hand]) - goal.act(tips[hand])))
    angles: Array = PchipInterpolator(knots[rows], np.array(found))(knots)
    reached = {}
    for hand, (place, turn) in tracks.items():
        turned = Slerp(knots[rows], Rotation.from_matrix(np.array(turns[hand])))(knots).as_matrix()
        shift = PchipInterpolator(knots[rows], np.array(shifts[hand]))(knots)
        reached[hand] = place + shift + (turn - turned) @ tips[hand], turned
    return angles, reached


def _chest(robot: Robot) -> Array:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    at: Array = data.oMf[robot.point("chest")].translation.copy()
    return at
