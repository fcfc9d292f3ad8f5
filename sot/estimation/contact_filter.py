"""Base pose and velocity from an inertial unit, encoders and feet that stand: a contact-aided invariant filter."""

from collections.abc import Mapping
from math import sqrt

import numpy as np
import pinocchio as pin

from sot.estimation import invariant
from sot.estimation.estimator import Footing
from sot.estimation.feet import MeasuredFeet, leg_length
from sot.estimation.invariant import Belief
from sot.estimation.noise import FilterNoise
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance
from sot.hardware.readings import Readings
from sot.hardware.sensors import Sensors
from sot.robots.robot import Robot

Array = np.ndarray

TOUCH_SHARE, LEAVE_SHARE = 0.05, 0.02
"""Load over the robot's weight from which a foot counts as standing, and below which it no longer does."""
FIRM_SHARE = 0.2
"""Load over the robot's weight from which a foot is trusted not to slip, and its sole to lie flat."""
SLIP_GATE = 22.46
"""Squared Mahalanobis distance of a foot's six coordinates beyond which it has moved: chi-square, 99.9 %."""
FLOOR_CORRELATION_RATIO = 0.3
"""Time for which an error of floor or foothold lasts, over √(leg / g)."""


class ContactFilter:
    """An `Estimator`: right-invariant extended Kalman filter after Hartley et al. (2020), with whole soles as contacts.

    The pose of a sole that stands is part of the belief and walks at random, more under little load. A foot that is
    farther from where it stood than noise explains has slipped: its pose becomes as uncertain as that distance, so that
    it moves and the body does not. Attitude readings are not used.

    Args:
        robot: the robot.
        sensors: its sensors, for their data sheets.
        compliance: of its feet, if they are soft.
        noise: how far readings, feet and floor are trusted; from the data sheets unless given.
    """

    def __init__(
        self,
        robot: Robot,
        sensors: Sensors,
        compliance: FootCompliance | None = None,
        noise: FilterNoise | None = None,
    ) -> None:
        self._robot, self._sensors, self._compliance = robot, sensors, compliance
        self.noise = noise or FilterNoise.of(robot, sensors)
        self._correlation_time = FLOOR_CORRELATION_RATIO * sqrt(leg_length(robot) / GRAVITY)
        self.reset(robot.rest, np.zeros(robot.nv))

    def reset(self, q: Array, v: Array) -> None:
        noise, feet = self.noise, len(self._robot.feet)
        self._feet = MeasuredFeet(self._robot, self._sensors.imu_point, self._compliance)
        unit, velocity = self._feet.unit(q, v)
        # Errors turn about the origin: beside the robot they stay small numbers wherever in the world it is.
        self._origin = unit.translation.copy()
        self.belief = Belief.empty(feet)
        self.belief.rotation[:], self.belief.velocity[:] = unit.rotation, velocity
        deviations = [noise.start_tilt, noise.start_tilt, noise.start_heading, *[noise.start_velocity] * 3]
        deviations += [noise.start_position] * 3 + [noise.gyro_bias] * 3 + [noise.accelerometer_bias] * 3
        np.fill_diagonal(self.belief.covariance[: invariant.FEET, : invariant.FEET], np.square(deviations))
        self.standing = np.zeros(feet, dtype=bool)
        """Which feet are part of the belief, in the order of `Robot.feet`."""
        self.slips = np.zeros(feet, dtype=int)
        """In how many readings each foot has been found to slip."""
        self._last: Readings | None = None

    @property
    def loads(self) -> Mapping[str, float]:
        return self._feet.loads

    def __call__(self, t: float, readings: Readings, standing: Mapping[str, Footing]) -> tuple[Array, Array]:
        last, belief = self._last or readings, self.belief
        passed = readings.time - last.time
        gyro = 0.5 * (last.angular_velocity + readings.angular_velocity)
        accelerometer = 0.5 * (last.specific_force + readings.specific_force)
        self._feet.update(readings, passed)
        if passed > 0.0:
            F = invariant.predict(belief, gyro, accelerometer, GRAVITY, passed)
            invariant.spread(belief, F, self._inertial_variance(), self._walk(passed))
        self._feet.weigh(readings, belief.rotation)
        for k, foot in enumerate(self._robot.feet):
            self._correct_by_foot(k, standing.get(foot), passed)
        self._last = readings
        return self._state_at(t, readings)

    def _inertial_variance(self) -> Array:
        return np.repeat(np.square([self.noise.gyro, self.noise.accelerometer]), 3)

    def _walk(self, passed: float) -> Array:
        """Variance that biases and feet gain in a time [s]."""
        noise, out = self.noise, np.zeros(len(self.belief.covariance))
        out[invariant.GYRO_BIAS : invariant.ACCELEROMETER_BIAS] = passed * noise.gyro_bias_walk**2
        out[invariant.ACCELEROMETER_BIAS : invariant.FEET] = passed * noise.accelerometer_bias_walk**2
        for k in np.flatnonzero(self.standing).tolist():
            at, loose = invariant.FEET + invariant.FOOT * k, self._looseness(k)
            out[at : at + 3] = passed * (loose * noise.slip) ** 2
            out[at + 3 : at + 6] = passed * (loose * noise.twist) ** 2
        return out

    def _looseness(self, k: int) -> float:
        """Factor on what a foot may slip, from its load; 1 for one that stands firm."""
        return max(1.0, (FIRM_SHARE / max(float(self._feet.shares[k]), LEAVE_SHARE)) ** 2)

    def _correct_by_foot(self, k: int, footing: Footing | None, passed: float) -> None:
        belief, noise, sole, share = self.belief, self.noise, self._feet.soles[k], self._feet.shares[k]
        sight = np.repeat(np.square([noise.sight_position, noise.sight_rotation]), 3)
        if footing is None or share < LEAVE_SHARE:
            self.standing[k] = False
            invariant.forget_foot(belief, k)
            return
        if not self.standing[k]:
            if share < TOUCH_SHARE:
                return
            self.standing[k] = True
            invariant.place_foot(belief, k, sole.translation, sole.rotation, sight)
        else:
            innovation = invariant.foot_innovation(belief, k, sole.translation, sole.rotation)
            rows = invariant.foot_rows(belief, k)
            if invariant.squared_distance(belief, rows, innovation, sight) > SLIP_GATE:
                self.slips[k] += 1
                at = invariant.FEET + invariant.FOOT * k
                belief.covariance[range(at, at + 6), range(at, at + 6)] += innovation**2
            invariant.correct(belief, rows, innovation, sight)
        if share >= FIRM_SHARE and passed > 0.0:
            self._correct_by_plan(k, footing, self._correlation_time / passed)

    def _correct_by_plan(self, k: int, footing: Footing, readings_per_error: float) -> None:
        """Correct by floor and foothold, whose errors last for a number of readings."""
        belief, noise = self.belief, self.noise
        if footing.floor is not None:
            normal, below = footing.floor.rotation[:, 2].copy(), footing.floor.translation - self._origin
            rotation, position = belief.foot_rotation[k], belief.foot_position[k]
            flat = pin.exp3(invariant.turn_between(rotation[:, 2].copy(), normal)) @ rotation
            place = pin.SE3(flat, position - normal * (normal @ (position - below)))
            self._correct_by_place(
                k, place, [2, 3, 4], [noise.floor_height, *[noise.floor_tilt] * 2], readings_per_error
            )
        if footing.foothold is not None:
            place = pin.SE3(footing.foothold.rotation, footing.foothold.translation - self._origin)
            deviations = [*[noise.foothold_position] * 2, noise.foothold_heading]
            self._correct_by_place(k, place, [0, 1, 5], deviations, readings_per_error)

    def _correct_by_place(
        self, k: int, place: pin.SE3, axes: list[int], deviations: list[float], readings_per_error: float
    ) -> None:
        innovation = invariant.place_innovation(self.belief, k, place.translation, place.rotation)[axes]
        rows = invariant.place_rows(self.belief, k, place.rotation)[axes]
        invariant.correct(self.belief, rows, innovation, np.square(deviations) * readings_per_error)

    def _state_at(self, t: float, readings: Readings) -> tuple[Array, Array]:
        """The belief as the robot's state, carried on from the readings' stamp to now."""
        belief, age = self.belief, t - readings.time
        turning = readings.angular_velocity - belief.gyro_bias
        acceleration = belief.rotation @ (readings.specific_force - belief.accelerometer_bias) - [0.0, 0.0, GRAVITY]
        base, velocity = self._feet.base(
            belief.rotation @ pin.exp3(age * turning),
            self._origin + belief.position + age * belief.velocity,
            belief.velocity + age * acceleration,
            turning,
        )
        q, v = np.empty(self._robot.nq), np.empty(self._robot.nv)
        q[:7] = pin.SE3ToXYZQUAT(base)
        q[7:] = readings.joint_position + age * readings.joint_velocity
        v[:6], v[6:] = velocity.vector, readings.joint_velocity
        return q, v
