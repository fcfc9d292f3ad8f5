"""A door with a lever that a robot unlatches, pushes open and walks through behind it: a motion without a human."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.ndimage import convolve1d

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.limits import Limits
from sot.motion.body.spline import Spline
from sot.motion.carrying.door_layout import DoorLayout, along_and_out
from sot.motion.carrying.led_arms import LedSurface, led_surfaces, surface_turns, with_hands_led
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.swing import FootPath, feet_heading, feet_middle
from sot.motion.trajectory import Motion
from sot.motion.way import Gait, footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.surface import Surface
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]
Key = tuple[float, Array, Array, float]
"""Where a surface is from a time [s] on: places (T, 3) [m], directions (T, 3) that it faces, accepted tilt [rad]."""

PRESSING_SURFACE, PUSHING_SURFACE = "left_palm", "right_hand_end"
KNOT_PERIOD = 0.02  # s, between knots
# The push turns the robot about the vertical, and on the edge of a foot there is no friction against that: steps are
# slow, and the pressure stays near the middle of the foot that stands alone.
GAIT = Gait(step=0.12, standing=4.0)
ZMP_INSET = (0.11, 0.07)  # leg lengths, along and across the feet
# In leg lengths.
PUSHING_HEIGHT = 1.33  # of the pushing hand's end
STANDING_BEHIND, STANDING_ASIDE = 0.52, 0.21  # of the body from the lever, before the door
STANDOFF = 0.16  # of a hand from what it touches, before it closes in
PAST_MARGIN = 0.1  # of the body's end beyond where it has to be
FOLLOWING_SHARE = 0.5  # of the way of the hand on the leaf, that the body follows it until the door is unlatched
HEADING_SHARE = 0.6  # of the door's angle, that the body turns
TOUCHING_TILT, FREE_TILT = 0.2, 1.0  # rad, of a hand's surface off where it should face, that is accepted
MAX_ERROR = 0.01  # m, of a hand that touches
MOVING_TIME, CLOSING_TIME, PRESSING_TIME, OPENING_TIME = 7.0, 4.0, 8.0, 16.0  # √(leg / g)
# After the body stands before the door, and after it has followed the door until it is unlatched.
WAITING_TIME = 2.0 + 2.0 * MOVING_TIME + CLOSING_TIME + PRESSING_TIME
LEAVING_TIME = OPENING_TIME + 2.0 * MOVING_TIME + 2.0 * CLOSING_TIME
TOUCH_SHARPNESS = 200.0  # 1/m, by which of a hand's corners the deepest ones count for where it touches
ARM_ROUNDS = 3  # of the body's balance and the arms, which shift one another


@dataclass(frozen=True)
class DoorPlan:
    """A motion through a door.

    Attributes:
        motion: of the robot; its ZMP counts the push.
        knots: times (T,) [s].
        angle: of the door at these times (T,) [rad].
        forces: surface of a hand -> force on it at these times (T, 3), world axes [N].
        touches: surface of a hand -> from its middle to where the force acts (T, 3), world axes [m].
    """

    motion: Motion
    knots: Array
    angle: Array
    forces: dict[str, Array]
    touches: dict[str, Array]


def pass_door(robot: Robot, door: DoorLayout, rate: float = 1000.0) -> DoorPlan:
    """The motion of a robot that opens a door and walks through.

    It steps up to the door, presses the lever with the left palm and pushes the leaf with the end of the right hand,
    until the bolt is past the frame. The left hand leaves the lever, and the robot walks through, its right hand on
    the leaf. Its balance is planned with the force on the hand, so that it leans against the door, and its arms with
    the body that leans.

    Args:
        robot: who passes.
        door: what it passes.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: arms or legs do not reach.
    """
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    height = PUSHING_HEIGHT * leg
    shoulder, rest_hands = _rest_places(robot)
    bar = door.on_lever(0.0)[0]
    before = Foothold(float(bar[0]) - STANDING_BEHIND * leg, float(bar[1]) + STANDING_ASIDE * leg, 0.0)
    followed = FOLLOWING_SHARE * float(door.pushed(door.unlatched)[0] - door.pushed(0.0)[0])
    closer = Foothold(before.x + followed, before.y, before.heading)
    after = _end(door, before, closer, shoulder, leg)
    walked = footsteps_along(robot, [before, closer, after], gait=GAIT, waits={0: WAITING_TIME, 1: LEAVING_TIME})
    times = _Times(walked.arrivals[0], unit)
    knots = KNOT_PERIOD * np.arange(np.ceil(walked.end / KNOT_PERIOD) + 1)
    phases, paths = walked.feet_at(robot, knots)
    stride = (GAIT.swing + GAIT.standing) * unit
    body = _smoothed(_body(paths), 2.0 * stride)

    def share(start: float, end: float) -> Array:
        return np.asarray(minimum_jerk((knots - start) / (end - start)))

    opening = share(times.pressed, times.opened)
    walked_angle = _smoothed(_walked_angle(door, closer, shoulder, body), stride)
    angle = np.where(knots < times.tucked, door.unlatched * opening, walked_angle)
    lever = door.pressed * (share(times.touched, times.pressed) - share(times.opened, times.off_lever))
    forces = {
        PRESSING_SURFACE: door.lever_force(angle, lever),
        PUSHING_SURFACE: door.leaf_force(angle, Spline.through(angle[:, None], KNOT_PERIOD).accelerations[:, 0]),
    }
    rest = {name: _with_body(body, *at) for name, at in rest_hands.items()}
    own, corners = robot.surface(PRESSING_SURFACE), np.zeros((len(knots), 1, 3))
    kept = np.setdiff1d(np.arange(robot.na), robot.joint_numbers("legs"))
    upper = np.tile(robot.rest[7 + kept], (len(knots), 1))
    place = np.tile([0.0, 0.0, height] - _chest(robot), (len(knots), 1))
    level = np.sum([force * [1.0, 1.0, 0.0] for force in forces.values()], axis=0)
    limits, nothing = Limits.of(robot), np.zeros(len(knots))
    for _ in range(ARM_ROUNDS):
        pressing, touch = _on_bar(door, angle, lever, corners)
        tracks = {
            PRESSING_SURFACE: _pressing(rest[PRESSING_SURFACE], pressing, STANDOFF * leg, times),
            PUSHING_SURFACE: _pushing(rest[PUSHING_SURFACE], door, leg, times, angle),
        }
        hands = [LedSurface(robot.surface(name), *_track(knots, keys)) for name, keys in tracks.items()]
        load = HeldLoad(kept, upper, nothing, "chest", place, level)
        motion = feet_led(robot, phases, paths, KNOT_PERIOD, rate, where="its way", load=load, inset=ZMP_INSET)
        y = from_configuration(motion.q[np.minimum(np.round(knots * rate).astype(int), len(motion.q) - 1)])
        led = with_hands_led(robot, limits, Spline.through(y, KNOT_PERIOD), hands).knots
        upper = led[:, 6 + kept]
        corners = _corners(robot, own) @ surface_turns(robot, led, own).transpose(0, 2, 1)
    found = led_surfaces(robot, y, hands)
    errors = np.column_stack([np.linalg.norm(a.place - b.place, axis=1) for a, b in zip(found, hands, strict=True)])
    touching = knots > times.touched
    while_pressing = touching & (knots < times.opened)
    if (worst := float(errors[np.column_stack([while_pressing, touching])].max())) > MAX_ERROR:
        raise InputError(f"{robot.label} does not reach where its hands should be on the door, by {worst:.3f} m")
    return DoorPlan(motion, knots, angle, forces, {PRESSING_SURFACE: touch, PUSHING_SURFACE: np.zeros_like(touch)})


class _Times:
    """When what is done before the walk through the door."""

    def __init__(self, arrived: float, unit: float) -> None:
        self.begin = arrived + unit
        self.raised = self.begin + MOVING_TIME * unit
        self.near = self.raised + MOVING_TIME * unit
        self.touched = self.near + CLOSING_TIME * unit
        self.pressed = self.touched + PRESSING_TIME * unit
        self.opened = self.pressed + OPENING_TIME * unit
        self.off_lever = self.opened + CLOSING_TIME * unit
        self.above = self.off_lever + CLOSING_TIME * unit
        self.back = self.above + MOVING_TIME * unit
        self.tucked = self.back + MOVING_TIME * unit


def _end(door: DoorLayout, before: Foothold, closer: Foothold, shoulder: Array, leg: float) -> Foothold:
    """Where the body is at the end: past the door, its arm half as far stretched again as before the closed door and
    when the door was unlatched."""
    heading = HEADING_SHARE * door.opened
    stances = ((0.0, before), (door.unlatched, closer))
    reach = np.mean([np.linalg.norm(door.pushed(a)[:2] - [one.x, one.y] - shoulder) for a, one in stances])
    arm = pin.utils.rotate("z", heading)[:2, :2] @ shoulder
    x = door.exit + PAST_MARGIN * leg
    hand = door.pushed(door.opened)
    ahead = float(hand[0] - x - arm[0])
    return Foothold(x, float(hand[1] - arm[1] - np.sqrt(max(reach**2 - ahead**2, 0.0))), heading)


def _walked_angle(door: DoorLayout, closer: Foothold, shoulder: Array, body: Array) -> Array:
    """Angle of the door (T,) at which the hand on it is as far from the shoulder as the body's way asks [rad].

    The arm stays as far stretched as when the door was unlatched until the door is open; then the body comes on.

    body: place and heading (T, 3).
    """
    grid = np.linspace(door.unlatched, door.opened, 400)
    hands = np.array([door.pushed(a)[:2] for a in grid.tolist()])

    def shoulders(places: Array) -> Array:
        c, s = np.cos(places[:, 2]), np.sin(places[:, 2])
        return places[:, :2] + np.column_stack([c * shoulder[0] - s * shoulder[1], s * shoulder[0] + c * shoulder[1]])

    wanted = np.linalg.norm(hands[0] - shoulders(np.array([[closer.x, closer.y, closer.heading]]))[0])
    distance = np.linalg.norm(hands - shoulders(body)[:, None], axis=2)
    enough = distance >= wanted
    first = np.where(enough.any(axis=1), enough.argmax(axis=1), len(grid) - 1)
    before_first = np.maximum(first - 1, 0)
    rows = np.arange(len(body))
    low, high = distance[rows, before_first], distance[rows, first]
    part = np.clip((wanted - low) / np.maximum(high - low, 1e-9), 0.0, 1.0)
    found: Array = np.maximum.accumulate(grid[before_first] + part * (grid[first] - grid[before_first]))
    return found


def _pressing(
    rest: tuple[Array, Array],
    pressing: Array,
    standoff: float,
    times: _Times,
) -> list[Key]:
    """The palm that presses the lever: over it from the side, down and along with it, and back the same way.

    pressing: places (T, 3) of the palm's middle while it presses.
    """
    up, down = np.array([0.0, 0.0, standoff]), np.tile([0.0, 0.0, -1.0], (len(pressing), 1))
    aside = standoff * np.array([-1.5, 3.0, 0.0])
    return [
        (times.begin, *rest, FREE_TILT),
        (times.raised, pressing + up + aside, down, FREE_TILT),
        (times.near, pressing + up, down, TOUCHING_TILT),
        (times.touched, pressing, down, TOUCHING_TILT),
        (times.off_lever, pressing, down, TOUCHING_TILT),
        (times.above, pressing + up, down, FREE_TILT),
        (times.back, pressing + up + aside, down, FREE_TILT),
        (times.tucked, *rest, FREE_TILT),
    ]


def _on_bar(door: DoorLayout, angle: Array, lever: Array, corners: Array) -> tuple[Array, Array]:
    """Places (T, 3) of a hand's middle while it presses the bar, and where it touches it from there (T, 3) [m].

    The palm cannot turn as far as the bar. So the bar slopes away under it, and whatever of the hand is deepest over
    the slope touches: the edge of the palm, or what sticks out beyond it. That is where the bar is to be pressed.

    corners: of the hand from its middle (T, n, 3), world axes.
    """
    turns = np.array([door.leaf(a).rotation for a in angle.tolist()])
    along, out = (np.einsum("tij,tj->ti", turns, way) for way in along_and_out(lever))
    depth = -np.einsum("tnj,tj->tn", corners, out)
    deepest = depth[lever.argmax()]
    weights = np.exp(TOUCH_SHARPNESS * (deepest - deepest.max()))
    touch = np.einsum("n,tnj->tj", weights / weights.sum(), corners)
    axis = np.array([door.leaf(a).act(door.lever) for a in angle.tolist()])
    ahead = door.press - np.einsum("tj,tj->t", touch, along)
    return axis + ahead[:, None] * along + (door.bar + depth.max(axis=1))[:, None] * out, touch


def _corners(robot: Robot, own: Surface) -> Array:
    """Corners (n, 3) of all surfaces of a surface's hand, from its middle, in its point's axes [m]."""
    others = [surface.corners_at_point for surface in robot.surfaces.values() if surface.point == own.point]
    corners: Array = np.concatenate(others) - own.placement.translation
    return corners


def _pushing(rest: tuple[Array, Array], door: DoorLayout, leg: float, times: _Times, angle: Array) -> list[Key]:
    """The hand's end that pushes the leaf."""
    on_leaf = np.array([door.pushed(a) for a in angle.tolist()]) + np.array([0.0, 0.0, PUSHING_HEIGHT * leg])
    normal = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(len(angle))])
    return [
        (times.raised, *rest, FREE_TILT),
        (times.near, on_leaf - STANDOFF * leg * normal, normal, TOUCHING_TILT),
        (times.touched, on_leaf, normal, TOUCHING_TILT),
    ]


def _with_body(body: Array, place: Array, facing: Array) -> tuple[Array, Array]:
    """Places and directions (T, 3) that go with the body, place and heading (T, 3)."""
    turns = np.array([pin.utils.rotate("z", h) for h in body[:, 2].tolist()])
    shifted = np.column_stack([body[:, :2], np.zeros(len(body))])
    return shifted + turns @ place, turns @ facing


def _track(knots: Array, keys: list[Key]) -> tuple[Array, Array, Array]:
    """What goes from one moving place to the next, at each from its time on until it leaves for the next one."""
    _, place, facing, first = keys[0]
    tilt = np.full(len(knots), first)
    for (start, *_), (end, places, directions, accepted) in pairwise(keys):
        part = np.asarray(minimum_jerk((knots - start) / (end - start)))[:, None]
        place = place + part * (places - place)
        facing = facing + part * (directions - facing)
        tilt = tilt + part[:, 0] * (accepted - tilt)
    return place, facing / np.linalg.norm(facing, axis=1, keepdims=True), tilt


def _body(paths: dict[str, FootPath]) -> Array:
    """Place and heading of the middle of the feet (T, 3)."""
    way = np.column_stack([feet_middle(paths), feet_heading(paths)])
    way[:, :2] -= way[0, :2]
    return way


def _smoothed(values: Array, window: float) -> Array:
    """Values (T, ...) without what is faster than a window [s]."""
    count = 2 * round(0.5 * window / KNOT_PERIOD) + 1
    weights = np.hanning(count + 2)[1:-1]
    smooth: Array = convolve1d(values, weights / weights.sum(), axis=0, mode="nearest")
    return smooth


def _rest_places(robot: Robot) -> tuple[Array, dict[str, tuple[Array, Array]]]:
    """Of a robot at rest: the level place (2,) of the shoulder whose hand pushes, and where hands' surfaces are and
    face."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    found = {}
    for name in (PRESSING_SURFACE, PUSHING_SURFACE):
        surface = robot.surface(name)
        assert surface.point is not None
        at = data.oMf[robot.point(surface.point)] * surface.placement
        found[name] = at.translation.copy(), at.rotation[:, 2].copy()
    return data.oMf[robot.point("right_shoulder")].translation[:2].copy(), found


def _chest(robot: Robot) -> Array:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    at: Array = data.oMf[robot.point("chest")].translation.copy()
    return at
