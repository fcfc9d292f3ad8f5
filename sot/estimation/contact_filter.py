"""Base pose and velocity from an inertial unit, encoders and feet that stand: a contact-aided invariant filter."""

from collections.abc import Mapping
from math import sqrt

import numpy as np
import pinocchio as pin

from sot.estimation import invariant
from sot.estimation.delays import PromptReadings
from sot.estimation.estimator import Footing
from sot.estimation.feet import MeasuredFeet, leg_length
from sot.estimation.filter_step import FootBeliefs, PlannedFeet, Variances, filter_step, robot_state
from sot.estimation.invariant import Belief
from sot.estimation.noise import FilterNoise
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance
from sot.hardware.readings import Readings
from sot.hardware.sensors import Sensors
from sot.robots.robot import Robot

Array = np.ndarray

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
        self._correlation_time = FLOOR_CORRELATION_RATIO * sqrt(leg_length(robot) / GRAVITY)
        self._weight = robot.mass * GRAVITY
        walks = [self.noise.gyro_bias_walk, self.noise.accelerometer_bias_walk]
        walks += [self.noise.slip, self.noise.twist] * len(robot.feet)
        self._variances = Variances(
            inertial=np.repeat(np.square([self.noise.gyro, self.noise.accelerometer]), 3),
            sight=np.repeat(np.square([self.noise.sight_position, self.noise.sight_rotation]), 3),
            floor=np.square([self.noise.floor_height, *[self.noise.floor_tilt] * 2]),
            foothold=np.square([*[self.noise.foothold_position] * 2, self.noise.foothold_heading]),
            walk=np.square(np.repeat([0.0, 0.0, 0.0, *walks], 3)),
        )
        self.reset(robot.rest, np.zeros(robot.nv))

    def reset(self, q: Array, v: Array) -> None:
        noise, feet, sensors = self.noise, len(self._robot.feet), self._sensors
        self._measured = MeasuredFeet(self._robot, sensors.imu_point, self._compliance)
        self._feet, self._planned = FootBeliefs.in_the_air(feet), PlannedFeet.empty(feet)
        self._floors: list[pin.SE3 | None] = [None] * feet
        lags = [sensors.angular_velocity.lag] * 3 + [sensors.specific_force.lag] * 3
        self._prompt = PromptReadings(np.array(lags + [sensors.joint_velocity.lag] * self._robot.na))
        unit, velocity = self._measured.unit_state(q, v)
        # Errors turn about the origin: beside the robot they stay small numbers wherever in the world it is.
        self._origin = unit.translation.copy()
        self.belief = Belief.empty(feet)
        self.belief.rotation[:], self.belief.velocity[:] = unit.rotation, velocity
        deviations = [noise.start_tilt, noise.start_tilt, noise.start_heading, *[noise.start_velocity] * 3]
        deviations += [noise.start_position] * 3 + [noise.gyro_bias] * 3 + [noise.accelerometer_bias] * 3
        np.fill_diagonal(self.belief.covariance[: invariant.FEET, : invariant.FEET], np.square(deviations))
        self._time: float | None = None

    @property
    def standing(self) -> Array:
        """Which feet are part of the belief (feet,), in the order of `Robot.feet`."""
        return self._feet.standing

    @property
    def slips(self) -> Array:
        """In how many readings each foot has been found to slip (feet,)."""
        return self._feet.slips

    @property
    def loads(self) -> Mapping[str, float]:
        return dict(zip(self._robot.feet, (self._weight * self._feet.share).tolist(), strict=True))

    def __call__(self, t: float, readings: Readings, standing: Mapping[str, Footing]) -> tuple[Array, Array]:
        passed = 0.0 if self._time is None else readings.time - self._time
        told = readings.angular_velocity, readings.specific_force, readings.joint_velocity
        self._prompt.update(np.concatenate(told), passed)
        mean = self._prompt.at(-0.5 * passed)
        self._measured.update(readings, passed)
        self._plan(standing)
        filter_step(
            self.belief,
            self._feet,
            self._measured.seen,
            self._planned,
            self._variances,
            mean[:3],
            mean[3:6],
            GRAVITY,
            passed,
            self._weight,
            self._correlation_time,
        )
        self._time = readings.time
        return self._state_at(t - readings.time, readings)

    def _plan(self, standing: Mapping[str, Footing]) -> None:
        """Note what is planned of the feet."""
        planned = self._planned
        for k, foot in enumerate(self._robot.feet):
            footing = standing.get(foot)
            planned.standing[k] = footing is not None
            floor = None if footing is None else footing.floor
            if floor is not self._floors[k]:
                self._floors[k], planned.height[k] = floor, np.nan
                if floor is not None:
                    planned.normal[k] = floor.rotation[:, 2]
                    planned.height[k] = planned.normal[k] @ (floor.translation - self._origin)
            if self._footholds:
                planned.position[k] = np.nan
                if footing is not None and footing.foothold is not None:
                    planned.position[k] = footing.foothold.translation - self._origin
                    planned.rotation[k] = footing.foothold.rotation

    def _state_at(self, age: float, readings: Readings) -> tuple[Array, Array]:
        """The belief as the robot's state, carried on from the readings' stamp for a time [s]."""
        then, now, unit = self._prompt.value, self._prompt.at(age), self._measured.unit_in_base
        q, v = robot_state(self.belief, then, now, GRAVITY, age, unit, self._origin, readings.joint_position)
        if self._measured.unit_moves:
            v[:6] -= self._measured.unit_velocity_by_joints()
        return q, v
