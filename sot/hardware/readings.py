"""What the sensors of a robot say at one instant, and the zero-moment point that follows from its feet's."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from sot.rotation import cross

Array = np.ndarray


@dataclass(frozen=True, slots=True)
class Readings:
    """All sensors at one instant, with their errors.

    Attributes:
        time: the instant [s].
        joint_position: encoders (na,) [rad], in the order of `Robot.joints`.
        joint_velocity: (na,) [rad/s].
        orientation: of the IMU's frame in the world (4,), quaternion xyzw.
        angular_velocity: gyro (3,), in the IMU's frame [rad/s].
        specific_force: accelerometer (3,), in the IMU's frame, acceleration less gravity: at rest it points up
            [m/s²].
        foot_wrench: foot -> force and moment of sole on foot (6,), measured above the bush; in the axes of the foot
            frame, the moment about its origin [N, N m]. A foot in the air feels the weight of its sole.
    """

    time: float
    joint_position: Array
    joint_velocity: Array
    orientation: Array
    angular_velocity: Array
    specific_force: Array
    foot_wrench: Mapping[str, Array] = field(default_factory=dict)


def measured_zmp(wrenches: Mapping[str, Array], feet: Mapping[str, pin.SE3]) -> Array:
    """Zero-moment point (2,) on z = 0 of the frame in which the feet are placed, Kim & Oh (29) and (30) [m].

    (30) leaves out the horizontal forces, which have no moment there while the feet are at z = 0; here they count.

    Args:
        wrenches: foot -> (6,), as in `Readings.foot_wrench`.
        feet: foot -> placement of its frame.

    Returns:
        nan where the feet carry nothing.
    """
    total = np.zeros(6)
    for foot, wrench in wrenches.items():
        force, arm = feet[foot].rotation @ wrench[:3], feet[foot].translation
        total[:3] += force
        total[3:] += feet[foot].rotation @ wrench[3:] + cross(arm, force)
    if not total[2] > 0.0:
        return np.full(2, np.nan)
    return np.array([-total[4], total[3]]) / total[2]
