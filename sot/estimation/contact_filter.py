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
        footholds: whether a foot is believed to stand where the plan puts it, which takes drift away.
    """

    def __init__(
        self,
        robot: Robot,
        sensors: Sensors,
        compliance: FootCompliance | None = None,
        noise: FilterNoise | None = None,
        footholds: bool = False,
    ) -> None:
        self._robot, self._sensors, self._compliance = robot, sensors, compliance
        self._footholds = footholds
        self.noise = noise or FilterNoise.of(robot, sensors)
        self._inertial_variance = np.repeat(np.square([self.noise.gyro, self.noise.accelerometer]), 3)
        self._sight_variance = np.repeat(np.square([self.noise.sight_position, self.noise.sight_rotation]), 3)
        self._floor_variance = np.square([self.noise.floor_height, *[self.noise.floor_tilt] * 2])
        self._foothold_variance = np.square([*[self.noise.foothold_position] * 2, self.noise.foothold_heading])
        walks = [self.noise.gyro_bias_walk, self.noise.accelerometer_bias_walk]
        walks += [self.noise.slip, self.noise.twist] * len(robot.feet)
        self._walk_rate = np.square(np.repeat([0.0, 0.0, 0.0, *walks], 3))
        self._correlation_time = FLOOR_CORRELATION_RATIO * sqrt(leg_length(robot) / GRAVITY)
        self.reset(robot.rest, np.zeros(robot.nv))

    def reset(self, q: Array, v: Array) -> None:
        noise, feet = self.noise, len(self._robot.feet)
        self._feet = MeasuredFeet(self._robot, self._sensors.imu_point, self._compliance)
        unit, velocity = self._feet.unit_state(q, v)
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
            walk = self._walk(passed)
            invariant.advance(belief, gyro, accelerometer, GRAVITY, passed, self._inertial_variance, walk)
        self._feet.weigh(readings, belief.rotation)
        for k, foot in enumerate(self._robot.feet):
            self._correct_by_foot(k, standing.get(foot), passed)
        self._last = readings
        return self._state_at(t, readings)

    def _walk(self, passed: float) -> Array:
        """Variance that biases and feet gain in a time [s]."""
        out = self._walk_rate * passed
        for k, share in enumerate(self._feet.shares):
            if share < FIRM_SHARE:
                looseness = (FIRM_SHARE / max(share, LEAVE_SHARE)) ** 2
                out[invariant.FEET + invariant.FOOT * k :][: invariant.FOOT] *= looseness**2
        return out

    def _correct_by_foot(self, k: int, footing: Footing | None, passed: float) -> None:
        belief, sole, share = self.belief, self._feet.soles[k], self._feet.shares[k]
        if footing is None or share < (LEAVE_SHARE if self.standing[k] else TOUCH_SHARE):
            if self.standing[k]:
                self.standing[k] = False
                invariant.forget_foot(belief, k)
            return
        if not self.standing[k]:
            self.standing[k] = True
            invariant.place_foot(belief, k, *sole, self._sight_variance)
        elif invariant.see_foot(belief, k, *sole, self._sight_variance, SLIP_GATE):
            self.slips[k] += 1
        if share < FIRM_SHARE or not passed:
            return
        readings_per_error = self._correlation_time / passed
        if footing.floor is not None:
            normal = footing.floor.rotation[:, 2].copy()
            height = float(normal @ (footing.floor.translation - self._origin))
            invariant.lay_flat(belief, k, normal, height, self._floor_variance * readings_per_error)
        if self._footholds and footing.foothold is not None:
            place = footing.foothold.translation - self._origin, footing.foothold.rotation.copy()
            invariant.put_on_foothold(belief, k, *place, self._foothold_variance * readings_per_error)

    def _state_at(self, t: float, readings: Readings) -> tuple[Array, Array]:
        """The belief as the robot's state, carried on from the readings' stamp to now."""
        age, robot = t - readings.time, self._robot
        rotation, position, velocity = invariant.base_state(
            self.belief, readings.angular_velocity, readings.specific_force, GRAVITY, age, self._feet.unit_in_base
        )
        q, v = np.empty(robot.nq), np.empty(robot.nv)
        q[:3], q[3:7] = self._origin + position, pin.Quaternion(rotation).coeffs()
        q[7:] = readings.joint_position + age * readings.joint_velocity
        v[:6], v[6:] = velocity, readings.joint_velocity
        if self._feet.unit_moves:
            v[:6] -= self._feet.unit_velocity_by_joints()
        return q, v
