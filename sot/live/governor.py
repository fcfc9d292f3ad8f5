"""A motion that follows targets as fast as range, velocity, acceleration and jerk allow, never stretching time."""

import numpy as np
import pinocchio as pin
import quadprog
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.acceleration_bounds import AccelerationBounds
from sot.gravity import GRAVITY
from sot.live.joint_preview import JointPreview
from sot.live.led_legs import LedLegs
from sot.live.state import coordinate_columns, pinocchio_state
from sot.motion.body.coordinates import rate_matrix, to_rotation
from sot.motion.body.limits import Limits
from sot.polygon import Polygon
from sot.robots.robot import Robot

Array = NDArray[np.float64]

APPROACH_RATE = 12.0
"""Rate at which an error dies out while it is small [1/s]."""
VELOCITY_GAIN = 48.0
"""Rate at which the velocity goes to the wanted one [1/s]: four times the other, critically damped."""
BRAKING_SHARE = 0.65
"""Share of the acceleration limit that is relied upon to stop at a target or at the end of the range."""
USABLE_VELOCITY_SHARE = 0.96
"""Share of the velocity limits that is gone for: an acceleration does not end at once."""
END_MARGIN = 0.01
"""Part at the ends of a joint's range where no target is put [rad]: bounds that act all the time make it tremble."""
JERK_TIME = 0.03
"""Time in which an acceleration goes from nothing to its limit [s]."""
MAX_RISING_SPEED, MAX_RISING_ACCELERATION = 1.0, 3.0
"""Bounds of the pelvis' vertical velocity [m/s] and acceleration [m/s²]."""
MAX_SHIFT_SPEED, MAX_SHIFT_ACCELERATION = 2.0, 9.0
"""The same of its horizontal ones: it shifts against what the upper body does, and would else have to tilt for that."""
MAX_PELVIS_SPEED, MAX_PELVIS_ACCELERATION = 4.0, 6.0
"""Bounds of the pelvis' velocity [rad/s] and acceleration [rad/s²]: the whole upper body turns with it."""
MAX_CHEST_ACCELERATION = 8.0
"""The same of the joints below the chest, which carry arms and head."""
ACCEPTED_LEG_EXCESS = 0.1
"""Acceleration of a leg's joint beyond its bounds that costs as much as the whole acceleration of the pelvis [rad/s²]:
there always is an answer."""
ACCEPTED_COM_ERROR = 0.1
"""Error of the centre of mass' acceleration that costs as much [m/s²]."""
ACCEPTED_ZMP_EXCESS = 0.03
"""Distance of the zero-moment point beyond its room that costs as much [m]."""


class Governor:
    """State y, ẏ, ÿ (nv,) of a motion that goes after targets; see `sot.motion.body.coordinates` for y.

    The wanted velocity is the target's, and that with which the error can still be braked away,

        v* = ẏ_t + sign(e) min(λ |e|, √(2 b |e|)),    ÿ* = k (v* − ẏ),

    and ÿ* is kept within Kim (14) in its viable form and changes by no more than the jerk allows. Legs follow from the
    base: of its accelerations the nearest is taken with which their joints keep the same bounds, too. Were each of its
    coordinates governed by itself, it would be led to mixtures that no standing legs reach. Horizontally it goes where
    the centre of mass is on its plan: a body beside it would stand on other legs.

    Args:
        robot: who moves.
        limits: of the coordinates y.
        legs: of the robot, led to where its feet are to be after the next period.
        start: coordinates to start from, at rest (nv,).
        period: between its steps [s].
        foresight: how much of the future will be known [s].
    """

    def __init__(
        self, robot: Robot, limits: Limits, legs: LedLegs, start: Array, period: float, foresight: float = 0.0
    ) -> None:
        self.y, self.dy, self.ddy = start.copy(), np.zeros_like(start), np.zeros_like(start)
        self._period, self._legs = period, legs
        velocity, acceleration = USABLE_VELOCITY_SHARE * limits.velocity, limits.acceleration.copy()
        velocity[:2], acceleration[:2] = MAX_SHIFT_SPEED, MAX_SHIFT_ACCELERATION
        velocity[2], acceleration[2] = MAX_RISING_SPEED, MAX_RISING_ACCELERATION
        velocity[3:6], acceleration[3:6] = MAX_PELVIS_SPEED, MAX_PELVIS_ACCELERATION
        chest = 6 + np.array(robot.groups["chest"], dtype=int)
        acceleration[chest] = np.minimum(acceleration[chest], MAX_CHEST_ACCELERATION)
        self._velocity, self._acceleration = velocity, acceleration
        brake = acceleration.copy()
        brake[legs.columns] = np.minimum(brake[legs.columns], MAX_PELVIS_ACCELERATION)  # it has to slow down with them
        self._limits = np.array([limits.lower, limits.upper, velocity])
        self._bounds = AccelerationBounds(limits.lower, limits.upper, velocity, BRAKING_SHARE * brake, acceleration)
        self._scale = acceleration[:6]
        self._weight = robot.mass * GRAVITY
        self._model, self._data = robot.model, robot.model.createData()
        self._com_motion = self._data.com[0], self._data.vcom[0], self._data.acom[0]  # live views
        self._free = np.setdiff1d(np.arange(2, robot.nv), legs.columns)  # neither shifts nor follows from the others
        limited = velocity[self._free], acceleration[self._free]
        self._preview = JointPreview(*limited, foresight) if foresight > 0.0 else None
        self._planned: Array | None = None

    def expected(self, target: Array, time: float) -> Array:
        """Coordinates (nv,) that would be reached within a time [s] at full speed towards a target (nv,)."""
        way = time * self._velocity
        return self.y + np.clip(target - self.y, -way, way)

    def plan(self, times: Array, targets: Array) -> None:
        """Plan the steps until the next plan from what is known of the future: targets (n, nv) at times from now [s].

        What an acceleration changes comes half of `JERK_TIME` late, and is planned from there on.
        """
        if self._preview is not None:
            lag, free = 0.5 * JERK_TIME, self._free
            rate = self.dy[free] + lag * self.ddy[free]
            place = self.y[free] + 0.5 * lag * (self.dy[free] + rate)
            wanted = [np.interp(self._preview.times + lag, times, column) for column in targets.T[free]]
            self._planned = self._preview(place, rate, np.transpose(wanted))

    def step(self, target: Array, velocity: Array, com: Array, room: Polygon | None = None) -> None:
        """Go on by a period towards a target (nv,) that moves with a velocity (nv,).

        com: place and velocity that the centre of mass shall have now, and its acceleration at the period's end (3, 2).
        room: where the zero-moment point may be, if the pelvis has to give way for that.
        """
        low, high = self._bounds(*_expected_state(self.y, self.dy, self.ddy), self._period)
        wanted = _wanted_accelerations(
            self.y,
            self.dy,
            self.ddy,
            target,
            velocity,
            self._limits,
            low,
            high,
            self._acceleration,
        )
        if self._planned is not None:
            wanted[self._free] = self._planned
        T = self._period
        curve, least, most = _rising_accelerations(wanted, self.ddy, low, high, self._acceleration, T / JERK_TIME)
        A, b = self._legs.accelerations(self.y, self.dy)
        legs = self._legs.columns
        zmp = None if room is None else self._zmp_rows(room, curve, com, A, b)
        curve[:6] = self._base_acceleration(curve, com, least[:6], most[:6], A, b, low[legs], high[legs], zmp)
        self.y = self.y + T * self.dy + T**2 * (self.ddy / 3.0 + curve / 6.0)
        self.dy = self.dy + 0.5 * T * (self.ddy + curve)
        self.ddy = curve
        self.y, self.dy, self.ddy = self._legs(self.y, self.dy, self.ddy)

    def _base_acceleration(
        self,
        curve: Array,
        com: Array,
        least: Array,
        most: Array,
        A: Array,
        b: Array,
        low: Array,
        high: Array,
        zmp: tuple[Array, Array] | None,
    ) -> Array:
        """The base's acceleration (6,) between least and most that takes the centre of mass along its plan.

        The other four are the nearest to those of curve (nv,) with which the accelerations A ÿ + b (k,) of the legs
        that stand are within bounds, but for an excess s that is solved for, too: low − s <= A ÿ + b <= high + s; and
        with which the zero-moment point is in its room, if rows Z (n, 6) and bounds (n,) of it are given: Z ÿ <= bound
        but for one excess of all.
        """
        C, wanted = self._com_rows(curve, com, A, b)
        stand = self._legs.stand
        base, is_within = _base_on_plan(curve[:6], C, wanted, least, most, A, b, low, high, stand)
        Z, inside = zmp if zmp is not None else (np.zeros((0, 6)), np.zeros(0))
        if is_within and (Z @ base <= inside).all():
            return base
        A, b, low, high = A[stand], b[stand], low[stand], high[stand]
        scale, width, count = self._scale, 1e-6, len(A)  # a box without any width has dependent constraints
        A, C, Z = A * scale, C * scale / ACCEPTED_COM_ERROR, Z * scale
        prices = np.append(np.full(count, ACCEPTED_LEG_EXCESS**-2), ACCEPTED_ZMP_EXCESS**-2)
        H = np.diag(np.concatenate([np.zeros(2), np.ones(4), prices]))
        H[:6, :6] += C.T @ C
        pull = np.concatenate([np.zeros(2), base[2:] / scale[2:], np.zeros(count + 1)])
        pull[:6] += C.T @ wanted / ACCEPTED_COM_ERROR
        one, excess = np.eye(6, 7 + count), np.eye(count, count + 1)
        beyond = np.hstack([-Z, np.zeros((len(Z), count)), np.ones((len(Z), 1))])
        rows = np.vstack([one, -one, np.hstack([A, excess]), np.hstack([-A, excess]), beyond])
        bounds = np.concatenate([least / scale - width, -most / scale - width, low - b, b - high, -inside])
        return np.clip(scale * quadprog.solve_qp(H, pull, rows.T, bounds)[0][:6], least, most)

    def _zmp_rows(self, room: Polygon, curve: Array, com: Array, A: Array, b: Array) -> tuple[Array, Array]:
        """Z (n, 6) and bounds (n,): with Z ÿ <= bound for the base's ÿ the zero-moment point is in a room.

        z = c − (c_z c̈ + (L̇_y, −L̇_x) / m) / g, with the centre of mass on its plan; else as `_com_rows`.
        """
        legs, others = self._legs.columns, curve.copy()
        others[:6], others[legs] = 0.0, b
        model, data = self._model, self._data
        q, v, a = pinocchio_state(self.y, self.dy, others)
        pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)
        turn, height = data.dhg.angular.copy(), float(data.com[0][2])
        momentum = pin.computeCentroidalMap(model, data, q)[3:]
        base = momentum[:, :6].copy()
        base[:, :3] = base[:, :3] @ to_rotation(self.y[None, 3:6])[0].T
        base[:, 3:] = base[:, 3:] @ rate_matrix(self.y[None, 3:6])[0]
        base += momentum[:, legs] @ A
        to_shift = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) / (self._weight)
        unmoved = com[0] - height / GRAVITY * com[2] - to_shift @ turn
        return -room.normals @ to_shift @ base, room.offsets - room.normals @ unmoved

    def _com_rows(self, curve: Array, com: Array, A: Array, b: Array) -> tuple[Array, Array]:
        """C (2, 6) and c (2,): with C ÿ = c for the base's ÿ the centre of mass goes along its plan.

        The legs' accelerations are A ÿ + b, those of the other joints are in curve (nv,).
        """
        legs, others = self._legs.columns, curve.copy()
        others[:6], others[legs] = 0.0, b
        q, v, a = pinocchio_state(self.y, self.dy, others)
        J = coordinate_columns(pin.jacobianCenterOfMass(self._model, self._data, q)[:2], self.y)
        pin.centerOfMass(self._model, self._data, q, v, a)
        place, rate, drift = self._com_motion
        wanted = com[2] + VELOCITY_GAIN * (com[1] - rate[:2] + APPROACH_RATE * (com[0] - place[:2]))
        return J[:, :6] + J[:, legs] @ A, wanted - drift[:2]


@compiled
def _expected_state(y: Array, dy: Array, ddy: Array) -> tuple[Array, Array]:
    """Coordinates and velocities (nv,) once the acceleration of now has come to an end."""
    rate = dy + 0.5 * JERK_TIME * ddy
    return y + JERK_TIME * rate, rate


@compiled
def _rising_accelerations(
    wanted: Array, now: Array, low: Array, high: Array, limit: Array, share: float
) -> tuple[Array, Array, Array]:
    """Wanted accelerations (nv,) within bounds and not farther from those of now than a share of the limit, and the
    least and greatest that are."""
    curve, least, most = np.empty_like(wanted), np.empty_like(wanted), np.empty_like(wanted)
    for k in range(len(wanted)):
        below, above = now[k] - share * limit[k], now[k] + share * limit[k]
        least[k], most[k] = min(max(low[k], below), above), min(max(high[k], below), above)
        curve[k] = min(max(min(max(wanted[k], low[k]), high[k]), least[k]), most[k])
    return curve, least, most


@compiled
def _base_on_plan(
    base: Array,
    C: Array,
    wanted: Array,
    least: Array,
    most: Array,
    A: Array,
    b: Array,
    low: Array,
    high: Array,
    stand: NDArray[np.bool_],
) -> tuple[Array, bool]:
    """The base's acceleration (6,) with its horizontal part from C ÿ = wanted, and whether all is within bounds."""
    out, right = base.copy(), wanted.copy()
    for i in range(2):
        for k in range(2, 6):
            right[i] -= C[i, k] * base[k]
    whole = C[0, 0] * C[1, 1] - C[0, 1] * C[1, 0]
    out[0] = (right[0] * C[1, 1] - C[0, 1] * right[1]) / whole
    out[1] = (C[0, 0] * right[1] - right[0] * C[1, 0]) / whole
    is_within = True
    for k in range(6):
        is_within = is_within and least[k] <= out[k] <= most[k]
    for i in range(len(b)):
        if stand[i]:
            leg = b[i]
            for k in range(6):
                leg += A[i, k] * out[k]
            is_within = is_within and low[i] <= leg <= high[i]
    return out, is_within


@compiled
def _wanted_accelerations(
    y: Array,
    dy: Array,
    ddy: Array,
    target: Array,
    velocity: Array,
    limits: Array,
    low: Array,
    high: Array,
    acceleration: Array,
) -> Array:
    """The accelerations (nv,) that go after the targets within bounds; limits: range and speed of each coordinate."""
    wanted = np.empty_like(y)
    lower, upper, fastest = limits
    for k in range(len(y)):
        brake = BRAKING_SHARE * acceleration[k]
        # what the velocity will be once the acceleration of now has come to an end
        asked = min(max(velocity[k], -fastest[k]), fastest[k])
        ahead = dy[k] - asked + 0.5 * ddy[k] * JERK_TIME
        error = min(max(target[k], lower[k] + END_MARGIN), upper[k] - END_MARGIN) - y[k]
        size = abs(error)
        bend = brake / APPROACH_RATE**2  # where the root takes over from the line, with the same slope
        speed = APPROACH_RATE * size if size < bend else np.sqrt(2.0 * brake * (size - 0.5 * bend))
        wanted[k] = min(max(VELOCITY_GAIN * ((speed if error > 0.0 else -speed) - ahead), low[k]), high[k])
    return wanted
