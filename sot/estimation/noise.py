"""How far the contact filter trusts sensors, feet and floor."""

from dataclasses import dataclass
from math import pi, sqrt

from sot.estimation.feet import leg_length
from sot.hardware.sensors import Sensors
from sot.robots.robot import Robot

DEGREE = pi / 180.0
MIN_GYRO_NOISE, MIN_ACCELEROMETER_NOISE = 0.05 * DEGREE, 0.3
"""Least noise of a reading [rad/s, m/s²]: links bend, and impacts fall between samples."""
MIN_GYRO_BIAS, MIN_ACCELEROMETER_BIAS = 0.5 * DEGREE, 0.2
"""Least standard deviation of a bias at the start [rad/s, m/s²], whatever the data sheet says."""
MIN_JOINT_NOISE = 1e-4
"""Least noise of an encoder [rad]: gears and links give way."""


@dataclass(frozen=True)
class FilterNoise:
    """Standard deviations; those of readings are for each one, walks grow with the root of the time.

    Attributes:
        gyro, accelerometer: of a reading [rad/s, m/s²].
        gyro_bias, accelerometer_bias: of the biases at the start.
        gyro_bias_walk, accelerometer_bias_walk: their change [rad/s/√s, m/s²/√s].
        sight_position, sight_rotation: of a sole as seen from the inertial unit through the joints [m, rad].
        slip, twist: of a sole that carries its share on the floor [m/√s, rad/√s].
        floor_height, floor_tilt: of the floor under a sole [m, rad].
        foothold_position, foothold_heading: of a planned foothold [m, rad].
        start_tilt, start_heading: of the robot when it is set down [rad].
        start_velocity, start_position: of it [m/s, m].
    """

    gyro: float
    accelerometer: float
    gyro_bias: float
    accelerometer_bias: float
    sight_position: float
    sight_rotation: float
    slip: float
    foothold_position: float
    start_position: float
    gyro_bias_walk: float = 1e-4
    accelerometer_bias_walk: float = 2e-3
    twist: float = 3e-3
    floor_height: float = 2e-3
    floor_tilt: float = 0.5 * DEGREE
    foothold_heading: float = 1.0 * DEGREE
    start_tilt: float = 1.0 * DEGREE
    start_heading: float = 0.1 * DEGREE
    start_velocity: float = 0.02

    @staticmethod
    def of(robot: Robot, sensors: Sensors) -> "FilterNoise":
        """From the data sheets of a robot's sensors; lengths scale with its legs."""
        leg = leg_length(robot)
        encoder = sensors.joint_position
        joint = max(encoder.noise, encoder.step / sqrt(12.0), MIN_JOINT_NOISE)
        joints_of_a_leg = sqrt(len(robot.groups["legs"]) / len(robot.feet))
        return FilterNoise(
            gyro=max(sensors.angular_velocity.noise, MIN_GYRO_NOISE),
            accelerometer=max(sensors.specific_force.noise, MIN_ACCELEROMETER_NOISE),
            gyro_bias=max(sensors.angular_velocity.bias, MIN_GYRO_BIAS),
            accelerometer_bias=max(sensors.specific_force.bias, MIN_ACCELEROMETER_BIAS),
            sight_position=joint * joints_of_a_leg * leg,
            sight_rotation=joint * joints_of_a_leg,
            slip=3e-3 * leg,
            foothold_position=0.01 * leg,
            start_position=1e-3 * leg,
        )
