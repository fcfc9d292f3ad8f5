"""The sensors of a robot and their errors, ideal unless told otherwise."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, pi, sqrt
from types import MappingProxyType

from sot.errors import InputError

GRAVITY = 9.81  # m/s² in a "g" of data sheets
DEGREE = pi / 180.0


@dataclass(frozen=True)
class Channel:
    """Errors of one measured quantity, each component alike.

    Attributes:
        noise: standard deviation of what is added to each reading, anew each time.
        bias: size of a constant offset of each component; its sign is drawn with the seed.
        lag: time constant of a first-order filter before the reading [s].
        step: the reading is rounded to multiples of it; 0 for none.

    Raises:
        InputError: a negative number, or one that is not finite.
    """

    noise: float = 0.0
    bias: float = 0.0
    lag: float = 0.0
    step: float = 0.0

    def __post_init__(self) -> None:
        for name in ("noise", "bias", "lag", "step"):
            if not 0.0 <= getattr(self, name) < inf:
                raise InputError(f"sensor {name}={getattr(self, name):g}: must be a number that is not negative")


IDEAL = Channel()


@dataclass(frozen=True)
class Sensors:
    """Encoders in all joints, an IMU on the trunk, and six-axis force sensors between feet and soles.

    Attributes:
        imu_point: the operational point of the robot whose frame is the IMU's.
        joint_position, joint_velocity: of the encoders [rad, rad/s].
        orientation: of the IMU's attitude, as a rotation vector in its frame [rad].
        angular_velocity: of its gyro [rad/s].
        specific_force: of its accelerometer [m/s²].
        force, moment: of the force sensors [N, N m].
        seed: of noise and of the signs of biases.
    """

    imu_point: str = "waist"
    joint_position: Channel = IDEAL
    joint_velocity: Channel = IDEAL
    orientation: Channel = IDEAL
    angular_velocity: Channel = IDEAL
    specific_force: Channel = IDEAL
    force: Channel = IDEAL
    moment: Channel = IDEAL
    seed: int = 0


def white_noise(density: float, bandwidth: float) -> float:
    """Standard deviation of a reading, from a noise density [unit/√Hz] and the sensor's bandwidth [Hz]."""
    return density * sqrt(pi / 2.0 * bandwidth)


ENCODER_STEP = 2.0 * pi / 2**19
"""Step of an encoder of 19 bits on the joint [rad]: assumed, a common size of absolute encoders."""
RATE_PERIOD_S = 1e-3
"""Time between two readings of an encoder whose difference is the joint's rate: assumed."""

_JOINTS_AND_FEET = Sensors(
    joint_position=Channel(step=ENCODER_STEP),
    joint_velocity=Channel(noise=ENCODER_STEP / RATE_PERIOD_S / sqrt(6.0), lag=0.5 * RATE_PERIOD_S),
    force=Channel(noise=0.25, step=0.25),
    moment=Channel(noise=1.0 / 188.0, step=1.0 / 188.0),
)
"""Encoders whose rate is the difference of two rounded readings: as noisy as that, half the time between them late.

Six-axis sensors ATI Mini45 with calibration SI-580-20, manual 9620-05, tables of the Mini45: resolution 1/4 N along
all axes, 1/188 N m about x and y (half of that about z). Noise as large as the resolution and no bias, as of a sensor
that is tared in the air, are assumed.
"""
_BMI088 = replace(
    _JOINTS_AND_FEET,
    angular_velocity=Channel(
        noise=white_noise(0.014 * DEGREE, 116.0),
        bias=1.0 * DEGREE,
        lag=1.0 / (2.0 * pi * 116.0),
        step=DEGREE / 131.072,
    ),
    specific_force=Channel(
        noise=white_noise(190e-6 * GRAVITY, 200.0),
        bias=0.02 * GRAVITY,
        lag=1.0 / (2.0 * pi * 200.0),
        step=GRAVITY / 10920.0,
    ),
    orientation=Channel(noise=0.5 * DEGREE, bias=0.5 * DEGREE),
)
"""Bosch BMI088, data sheet BST-BMI088-DS000, revision 1.9, typical values, the worst axis for all three.

Table 5, gyroscope: noise 0.014 °/s/√Hz; zero-rate offset 1 °/s; 131.072 LSB per °/s at ±250 °/s. Table 4,
accelerometer: noise 190 µg/√Hz (z, at ±3 g); zero-g offset 20 mg; 10,920 LSB/g at ±3 g. Bandwidths are those of the
settings at which the two give synchronous data at 1 kHz: gyroscope 116 Hz at an output rate of 1000 Hz (5.5.6),
accelerometer 200 Hz along z at 800 Hz (4.4.1), both as filters of first order. The unit gives no attitude: half a
degree for whatever makes one of its readings is assumed.
"""
_MTI630 = replace(
    _JOINTS_AND_FEET,
    angular_velocity=Channel(noise=white_noise(0.007 * DEGREE, 520.0), bias=0.2 * DEGREE, lag=1.0 / (2.0 * pi * 520.0)),
    specific_force=Channel(
        noise=white_noise(60e-6 * GRAVITY, 500.0), bias=0.002 * GRAVITY, lag=1.0 / (2.0 * pi * 500.0)
    ),
    orientation=Channel(noise=0.02 * DEGREE, bias=0.2 * DEGREE),
)
"""Xsens MTi-630, MTi 600-series data sheet MT1603P, revision 2020.B.

Gyroscope: noise 0.007 °/s/√Hz, bandwidth 520 Hz; accelerometer: 60 µg/√Hz, 500 Hz; roll and pitch 0.2° rms. Of biases
the sheet has how much they wander (8 °/h, 15 µg), not what is left after the factory's calibration: 0.2 °/s and 2 mg
are assumed, as is the noise of the attitude, 0.02°, of which 0.2° is taken as a bias.
"""

SENSOR_PRESETS: Mapping[str, Sensors] = MappingProxyType({"ideal": Sensors(), "bmi088": _BMI088, "mti630": _MTI630})
"""Sensors by the names of their inertial units, with figures of data sheets."""


def sensor_preset(name: str, seed: int = 0) -> Sensors:
    """Sensors by name.

    Raises:
        InputError: no such preset.
    """
    if name not in SENSOR_PRESETS:
        raise InputError(f"unknown sensors '{name}': choose one of {', '.join(SENSOR_PRESETS)}")
    return replace(SENSOR_PRESETS[name], seed=seed)
