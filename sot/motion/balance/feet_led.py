"""A motion led by its feet: their paths are given, the centre of mass keeps balance, the posture stays near rest."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.control.tick import Tick
from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.held_load import HeldLoad
from sot.motion.balance.programme import plan_balance
from sot.motion.body.coordinates import from_configuration, to_pinocchio
from sot.motion.body.height import reachable_hip_height, smooth_height_below
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import Phase
from sot.motion.feet.support import ZMP_INSET, supports
from sot.motion.feet.swing import FootPath, feet_heading
from sot.motion.footing import footing_on
from sot.motion.human.human import SIDES
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

Array = NDArray[np.float64]
GroundHeight = Callable[[Array, Array], Array]

BALANCE_ROUNDS = 2  # of balance and inverse kinematics: the second knows the body's height and momentum
NEWTON_STEPS = 4  # of inverse kinematics at each knot, from the knot before
REACH_TOLERANCE = 1e-2  # m and rad, before the last Newton step, of what is within reach
ROUNDING = 1e-9  # rad
RANGE_TOLERANCE = 1e-3  # rad, by which a joint may be beyond its range
HOMEWARD_SHARE = (
    0.1  # of the way to the rest posture in a Newton step, within the null space of feet and centre of mass
)


def feet_led(
    robot: Robot,
    phases: Sequence[Phase],
    paths: Mapping[str, FootPath],
    period: float,
    rate: float,
    ground_height: GroundHeight | None = None,
    where: str = "the floor",
    load: HeldLoad | None = None,
    inset: tuple[float, float] = ZMP_INSET,
) -> Motion:
    """The motion of a robot whose feet follow paths, its waist upright, its centre of mass as high as at rest.

    Where legs would not reach, it is lower. The waist turns as the feet do. A load may have it lower, and the waist
    pitched.

    Args:
        robot: who moves.
        phases: which feet carry when, from time zero on.
        paths: foot -> where it is to be at T knots.
        period: time between knots [s].
        rate: samples per second of the motion [Hz].
        ground_height: of what the robot is over, at times (n,) and horizontal places (n, 2) of its centre of mass, (n,)
            [m]: the centre of mass rises with it. The floor's unless given.
        where: what the robot moves on, in words.
        load: what it holds: the centre of mass and the momentum of the motion are then those of both.
        inset: of the ZMP from the edge of the support, along and across the feet [leg lengths].

    Raises:
        InputError: legs do not reach.
    """
    height = ground_height or (lambda _, places: np.zeros(len(places)))
    rest = Tick(robot)
    middle, heading = np.mean([path.position[:, :2] for path in paths.values()], axis=0), feet_heading(paths)
    turns = Rotation.from_euler("z", heading[:, None]).as_matrix()
    wanted, knots = rest.com[:2] + middle - middle[0], period * np.arange(len(middle), dtype=float)
    wanted += (turns[:, :2, :2] - np.eye(2)) @ (rest.com[:2] - middle[0])
    if load is not None:
        height_at_rest = float(rest.frame(load.point).position[2] + load.place[:, 2].mean())
        wanted = wanted + load.com_shift(height_at_rest, robot.mass * GRAVITY)
        pitched = np.column_stack([np.zeros((len(load.pitch), 1)), load.pitch])
        turns = turns @ Rotation.from_euler("xy", pitched).as_matrix()
    nothing = np.zeros((len(middle), 6))
    state = Centroidal(np.tile(rest.com, (len(middle), 1)), nothing, nothing, robot.mass)
    for _ in range(BALANCE_ROUNDS):
        com = plan_balance(state, wanted, supports(robot, phases, inset), period).com.knots
        rise = height(knots, com)
        heights = rest.com[2] + rise - _drop(robot, com - rest.com[:2], rise, heading, paths, period)
        if load is not None:
            heights = heights - load.lowered
        q = _configurations_following(
            robot, np.column_stack([com, heights]), turns, paths, phases[0], period, where, load
        )
        spline = Spline.through(from_configuration(q), period)
        state = Centroidal.along(robot, *_sampled(spline, knots))
        if load is not None:
            state = load.combined(robot, state, q, period, knots)
        state = _above_ground(state, knots, height)
    times = np.arange(round(spline.duration * rate) + 1) / rate
    sampled = _sampled(spline, times)
    if load is None:
        state = Centroidal.along(robot, *sampled)
    else:
        state = load.combined(robot, Centroidal.along(robot, *_sampled(spline, knots)), q, period, times)
    return Motion(
        robot,
        rate,
        *sampled,
        com=state.com,
        com_velocity=state.velocity,
        com_acceleration=state.acceleration,
        zmp=_above_ground(state, times, height).zmp(),
        momentum=state.momentum[:, 3:],
        phases=tuple(phases),
    )


def _sampled(spline: Spline, times: Array) -> tuple[Array, Array, Array]:
    """Configurations, velocities and accelerations at times (T,)."""
    return to_pinocchio(*(spline(times, order) for order in range(3)))


def _above_ground(state: Centroidal, times: Array, height: GroundHeight) -> Centroidal:
    """The state with heights that count from the ground."""
    return state.above(height(times, state.com[:, :2]))


def _drop(robot: Robot, way: Array, rise: Array, heading: Array, paths: Mapping[str, FootPath], period: float) -> Array:
    """How much lower (T,) than at rest the body has to be for both legs to reach [m].

    way: of the body from rest (T, 2), rise: of the ground under it (T,) [m]; heading: of the body (T,) [rad].
    """
    y = np.tile(from_configuration(robot.rest[None])[0], (len(way), 1))
    y[:, :2] += way
    y[:, 2] += rise
    y[:, 5] += heading
    hips = rise + float(np.mean([Tick(robot).frame(f"{side}_hip").position[2] for side in SIDES]))
    highest = reachable_hip_height(robot, y, paths)
    if (hips <= highest).all():
        return np.zeros(len(rise))
    lowered = smooth_height_below(hips, highest, period).knots[:, 0]
    drop: Array = hips - lowered
    return drop


def _configurations_following(
    robot: Robot,
    com: Array,
    turns: Array,
    paths: Mapping[str, FootPath],
    start: Phase,
    period: float,
    where: str,
    load: HeldLoad | None,
) -> Array:
    """Configurations (T, nq): Newton steps on CoM, waist and feet; the joints go home in their null space.

    turns: of the waist (T, 3, 3). What holds a load is where it is to be.

    Raises:
        InputError: they would be beyond the joints' ranges, or legs do not reach.
    """
    tick, nothing = Tick(robot), np.zeros(robot.nv)
    q = footing_on(robot, start.surfaces).q
    out, held = np.empty((len(com), robot.nq)), np.zeros(robot.nv, dtype=bool)
    if load is not None:
        held[6 + load.joints] = True
    for k, centre in enumerate(com):
        for _ in range(NEWTON_STEPS):
            tick.update(0.0, q, nothing)
            waist = tick.frame("waist")
            now, J_com = (tick.com, tick.com_jacobian) if load is None else load.combined_com(tick, k)
            jacobians, errors = [J_com, waist.jacobian[3:]], [centre - now, pin.log3(turns[k] @ waist.rotation.T)]
            for foot, path in paths.items():
                frame = tick.frame(foot)
                jacobians.append(frame.jacobian)
                errors += [path.position[k] - frame.position, pin.log3(path.rotation[k] @ frame.rotation.T)]
            J, error = np.vstack(jacobians), np.concatenate(errors)
            home = np.concatenate([np.zeros(6), HOMEWARD_SHARE * (robot.rest[7:] - q[7:])])
            if load is not None:
                home[6 + load.joints] = load.angles[k] - q[7 + load.joints]
            q = pin.integrate(robot.model, q, _step_within(robot, q, J, error, home, held))
        beyond = np.maximum(robot.lower - q[7:], q[7:] - robot.upper)
        if not np.abs(error).max() < REACH_TOLERANCE or beyond.max() > RANGE_TOLERANCE:
            raise InputError(
                f"{robot.label} cannot walk on {where} like that: its legs do not reach at {k * period:.1f} s"
            )
        out[k] = q
    return out


def _step_within(robot: Robot, q: Array, J: Array, error: Array, home: Array, held: NDArray[np.bool_]) -> Array:
    """Newton step (nv,) for ``J step = error``, and home otherwise; joints stay at the ends of their ranges.

    What is held (nv,) goes home in any case.
    """
    fixed = home
    while True:
        step: Array = fixed + np.linalg.pinv(np.where(held, 0.0, J), rcond=1e-6) @ (error - J @ fixed)
        ends = np.concatenate([step[:6], np.clip(q[7:] + step[6:], robot.lower, robot.upper) - q[7:]])
        if (beyond := ~held & (np.abs(step - ends) > ROUNDING)).any():
            held, fixed = held | beyond, np.where(beyond, ends, fixed)
        else:
            return step
