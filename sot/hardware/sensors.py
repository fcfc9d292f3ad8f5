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
"""Step of a 19-bit encoder on the joint [rad]."""
# Encoders on the joints; ATI Mini45 SI-580-20: resolution 1/4 N and 1/188 N m, tared.
_JOINTS_AND_FEET = Sensors(
    joint_position=Channel(step=ENCODER_STEP),
    joint_velocity=Channel(noise=0.005, lag=0.002),
    force=Channel(noise=0.25, step=0.25),
    moment=Channel(noise=1.0 / 188.0, step=1.0 / 188.0),
)

SENSOR_PRESETS: Mapping[str, Sensors] = MappingProxyType(
    {
        "ideal": Sensors(),
        # Bosch BMI088: 0.014 °/s/√Hz at 47 Hz, offset 1 °/s, 16 bits of ±250 °/s; 175 µg/√Hz at 40 Hz, offset 20 mg,
        # 16 bits of ±3 g.
        "bmi088": replace(
            _JOINTS_AND_FEET,
            angular_velocity=Channel(
                white_noise(0.014 * DEGREE, 47.0), 1.0 * DEGREE, 1.0 / (2 * pi * 47.0), 250.0 / 2**15 * DEGREE
            ),
            specific_force=Channel(
                white_noise(175e-6 * GRAVITY, 40.0), 0.02 * GRAVITY, 1.0 / (2 * pi * 40.0), 3.0 / 2**15 * GRAVITY
            ),
            orientation=Channel(noise=0.5 * DEGREE, bias=0.5 * DEGREE),
        ),
        # Xsens MTi-630: 0.007 °/s/√Hz at 520 Hz, 60 µg/√Hz at 500 Hz, roll and pitch 0.2° rms.
        "mti630": replace(
            _JOINTS_AND_FEET,
            angular_velocity=Channel(white_noise(0.007 * DEGREE, 520.0), 0.2 * DEGREE),
            specific_force=Channel(white_noise(60e-6 * GRAVITY, 500.0), 0.002 * GRAVITY),
            orientation=Channel(noise=0.02 * DEGREE, bias=0.2 * DEGREE),
        ),
    }
)
"""Sensors by the names of their inertial units, with figures of data sheets."""


def sensor_preset(name: str, seed: int = 0) -> Sensors:
    """Sensors by name.

    Raises:
        InputError: no such preset.
    """
    if name not in SENSOR_PRESETS:
        raise InputError(f"unknown sensors '{name}': choose one of {', '.join(SENSOR_PRESETS)}")
    return replace(SENSOR_PRESETS[name], seed=seed)
