"""A reference that is made while it is asked for; it answers what a `Motion` does, without a future."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.control.pose import Pose
from sot.gravity import GRAVITY
from sot.live.com_preview import KNOT_PERIOD
from sot.live.footing import Footing, PlantedFooting
from sot.live.governor import Governor
from sot.live.led_legs import LedLegs
from sot.live.state import pinocchio_state
from sot.motion.body.coordinates import from_configuration, to_pinocchio
from sot.motion.body.limits import Limits
from sot.motion.trajectory import Motion, MotionSample
from sot.robots.robot import Robot
from sot.rotation import product, rotation_of_vector

Array = NDArray[np.float64]

PERIOD = 0.01
"""Time between the knots of the reference [s]."""
KNOTS_PER_PLAN = round(KNOT_PERIOD / PERIOD)


@dataclass(frozen=True)
class Knot:
    """The reference at one time: coordinates and derivatives (nv,), CoM and derivatives (3,), ZMP (2,), angular
    momentum (3,), and each point's pose."""

    y: Array
    dy: Array
    ddy: Array
    com: Array
    com_velocity: Array
    com_acceleration: Array
    zmp: Array
    momentum: Array
    poses: dict[str, Pose]


class FutureTarget(NamedTuple):
    """What will be asked for later.

    Attributes:
        later: by how much [s].
        y: coordinates (nv,) then.
        com_shift: how much farther the centre of mass will be wanted (2,) [m].
    """

    later: float
    y: Array
    com_shift: Array


class LiveReference:
    """A robot motion that follows targets as they come; a `sot.motion.trajectory.Reference`.

    Between two knots, PERIOD apart, accelerations are linear. Times before the last two knots are not answered, they
    get the older of the two.

    Args:
        robot: who moves, from its rest posture.
        limits: of the coordinates.
        foresight: how much of the future will be known [s].
        footing: what it stands on; feet that stay unless given.
    """

    duration = inf

    def __init__(self, robot: Robot, limits: Limits, foresight: float = 0.0, footing: Footing | None = None) -> None:
        self.robot, self.foresight, self._footing = robot, foresight, footing or PlantedFooting(robot)
        self._data, self._mass = robot.model.createData(), pin.computeTotalMass(robot.model)
        self.rest = from_configuration(robot.rest[None])[0]
        self._points: dict[str, int] = {}
        self._legs = LedLegs(robot, self._footing.start, self.rest)
        self._governor = Governor(robot, limits, self._legs, self.rest, PERIOD, foresight)
        self._com, self._com_height = np.zeros(2), 0.0
        self._knots: list[Knot] = []
        self._knots.append(self._knot())
        self._step(self.rest, np.zeros(robot.nv))

    @property
    def horizon(self) -> float:
        """Time up to which it is made [s]."""
        return (len(self._knots) - 1) * PERIOD

    def next_knot_after(self, t: float) -> float:
        """Time of the first knot that is made with what is known at a time [s]: from then on the robot can tell."""
        return PERIOD * np.ceil(t / PERIOD - 1e-6)

    @property
    def now(self) -> Array:
        """Coordinates (nv,) at the last knot."""
        return self._knots[-1].y

    def expected(self, target: Array, t: float) -> Array:
        """Coordinates (nv,) where it could be at a time [s] on the way to a target (nv,), not before the last knot."""
        return self._governor.expected(target, max(t - self.horizon, 0.0))

    def advance(self, target: Array, velocity: Array, future: Sequence[FutureTarget] = ()) -> None:
        """Make the next knot, towards a target (nv,) that moves with a velocity (nv,); future: in order, if known."""
        self._step(target, velocity, future)

    def _step(self, target: Array, velocity: Array, future: Sequence[FutureTarget] = ()) -> None:
        if (len(self._knots) - 1) % KNOTS_PER_PLAN == 0:
            times = np.array([0.0, *(one.later for one in future)])
            self._governor.plan(times, np.array([target, *(one.y for one in future)]))
        t, wanted = self.horizon, self._com + target[:2] - self._governor.y[:2]
        shifts = [(one.later, one.com_shift) for one in future]
        com = self._footing.advance(t, PERIOD, wanted, shifts, self._com_height)
        if poses := self._footing.poses(t + PERIOD):
            self._legs.lead(poses)
        self._governor.step(target, velocity, com, self._footing.room)
        self._knots.append(self._knot())

    def _knot(self) -> Knot:
        governor, model, data = self._governor, self.robot.model, self._data
        y, dy, ddy = governor.y, governor.dy, governor.ddy
        q, v, a = pinocchio_state(y, dy, ddy)
        pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)  # places and moves the joints, too
        hg, dhg = data.hg, data.dhg
        momentum, turn = hg.angular.copy(), dhg.angular
        com, velocity, acceleration = data.com[0].copy(), hg.linear / self._mass, dhg.linear / self._mass
        self._com, self._com_height = com[:2].copy(), float(com[2])
        com[:2], velocity[:2], acceleration[:2] = self._footing.com
        lean = (com[2] * acceleration[:2] + np.array([turn[1], -turn[0]]) / self.robot.mass) / (
            GRAVITY + acceleration[2]
        )
        poses = {point: self._pose(frame) for point, frame in self._points.items()}
        return Knot(y, dy, ddy, com, velocity, acceleration, com[:2] - lean, momentum, poses)

    def _pose(self, frame: int) -> Pose:
        model, data, axes = self.robot.model, self._data, pin.LOCAL_WORLD_ALIGNED
        place = pin.updateFramePlacement(model, data, frame)
        return Pose(
            place.translation.copy(),
            place.rotation.copy(),
            pin.getFrameVelocity(model, data, frame, axes).vector,
            pin.getFrameClassicalAcceleration(model, data, frame, axes).vector,
        )

    def _pose_at(self, knot: Knot, point: str) -> Pose:
        if point not in knot.poses:  # of a knot before the point was first asked for
            q, v, a = pinocchio_state(knot.y, knot.dy, knot.ddy)
            pin.forwardKinematics(self.robot.model, self._data, q, v, a)
            knot.poses[point] = self._pose(self._points[point])
        return knot.poses[point]

    def _between(self, t: float) -> tuple[Knot, Knot, float]:
        """The knots around a time [s], and how long ago the first was."""
        k = min(max(int(t / PERIOD + 1e-6), 0), len(self._knots) - 2)
        return self._knots[k], self._knots[k + 1], min(max(t - k * PERIOD, 0.0), PERIOD)

    def joints(self, t: float) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of the joints at a time [s], (na,) each."""
        last, following, dt = self._between(t)
        y, dy, ddy = _state_between(last.y, last.dy, last.ddy, following.ddy, dt)
        return y[6:], dy[6:], ddy[6:]

    def balance(self, t: float) -> tuple[Array, Array, Array, Array]:
        """CoM (3,), its velocity and acceleration, and the ZMP (2,) at a time [s]."""
        last, following, dt = self._between(t)
        c, dc, ddc = _state_between(last.com, last.com_velocity, last.com_acceleration, following.com_acceleration, dt)
        return c, dc, ddc, last.zmp + dt / PERIOD * (following.zmp - last.zmp)

    def angular_momentum(self, t: float) -> Array:
        """Angular momentum about the centre of mass at a time [s], (3,), world axes [N m s]."""
        last, following, dt = self._between(t)
        return last.momentum + dt / PERIOD * (following.momentum - last.momentum)

    @property
    def feet(self) -> dict[str, Callable[[float], Array]]:
        """Function of each foot that gives its foothold (3,) [m] at a time [s]; during a swing, the nearest in time."""
        return {foot: partial(self._footing.foothold, foot) for foot in self.robot.feet}

    def pose(self, point: str) -> Callable[[float], Pose]:
        """An operational point's pose, velocity and acceleration at a time [s].

        Raises:
            InputError: the robot has no such point.
        """
        frame = self.robot.point(point)
        self._points[point] = frame

        def at(t: float) -> Pose:
            last, following, dt = self._between(t)
            one, other = self._pose_at(last, point), self._pose_at(following, point)
            return Pose(*_pose_between(*one, other.acceleration, dt))

        return at

    def sample(self, t: float) -> MotionSample:
        """The whole state at a time [s]."""
        last, following, dt = self._between(t)
        q, v, a = pinocchio_state(*_state_between(last.y, last.dy, last.ddy, following.ddy, dt))
        return MotionSample(q, v, a, *self.balance(t))

    def recorded(self, duration: float, rate: float) -> Motion:
        """What it was from its start on, as a motion of a duration [s] at a rate [Hz]."""
        times = np.arange(round(duration * rate) + 1) / rate
        k = np.minimum((times / PERIOD + 1e-6).astype(int), len(self._knots) - 2)
        dt = np.clip(times - k * PERIOD, 0.0, PERIOD)[:, None]

        def column(name: str) -> Array:
            return np.array([getattr(knot, name) for knot in self._knots])

        def interpolated(value: str, rate: str, curve: str) -> tuple[Array, Array, Array]:
            curves = column(curve)
            return _interpolated(column(value)[k], column(rate)[k], curves[k], curves[k + 1], dt)

        q, v, a = to_pinocchio(*interpolated("y", "dy", "ddy"))
        com, com_velocity, com_acceleration = interpolated("com", "com_velocity", "com_acceleration")
        zmp, momentum = (
            values[k] + dt / PERIOD * (values[k + 1] - values[k]) for values in (column("zmp"), column("momentum"))
        )
        phases = self._footing.phases(float(times[-1]))
        return Motion(self.robot, rate, q, v, a, com, com_velocity, com_acceleration, zmp, momentum, phases)


def _interpolated(x: Array, dx: Array, ddx: Array, following: Array, dt: float | Array) -> tuple[Array, Array, Array]:
    """Value and derivatives dt after a knot, the second derivative linear to that of the following knot."""
    curve = ddx + dt / PERIOD * (following - ddx)
    return x + dt * dx + dt**2 * (ddx / 3.0 + curve / 6.0), dx + 0.5 * dt * (ddx + curve), curve


@compiled
def _state_between(x: Array, dx: Array, ddx: Array, following: Array, dt: float) -> tuple[Array, Array, Array]:
    """`_interpolated` of one moment."""
    curve = ddx + dt / PERIOD * (following - ddx)
    return x + dt * dx + dt**2 * (ddx / 3.0 + curve / 6.0), dx + 0.5 * dt * (ddx + curve), curve


@compiled
def _pose_between(
    position: Array, rotation: Array, velocity: Array, acceleration: Array, following: Array, dt: float
) -> tuple[Array, Array, Array, Array]:
    """A pose dt after another one, with its velocity and its acceleration, which is linear to a following one."""
    move, rate, curve = _state_between(np.zeros(6), velocity, acceleration, following, dt)
    return position + move[:3], product(rotation_of_vector(move[3:]), rotation), rate, curve
