"""The static deflection of compliant feet under their planned load, undone at the feet."""

import numpy as np

from sot.hardware.compliance import FootCompliance
from sot.servo.load_sharing import FootLoad
from sot.servo.posture_correction import FootOffset

Array = np.ndarray


def sag_offset(load: FootLoad, compliance: FootCompliance, bush: Array) -> FootOffset:
    """What a foot is to be turned and lowered by so that its load deflects it back to the plan.

    The moment about the bush, M + (o − b) × F, turns the sole by M / K against the foot; as the sole lies flat, the foot
    turns by −M / K against the floor, and all of the robot with it. An upright pendulum multiplies that by
    K / (K − m g l). Turned by −M / K beforehand, the foot leaves the robot where it was meant to be.

    Args:
        load: planned, about the origin o of the foot frame.
        compliance: of the bush.
        bush: its middle b (3,) in the foot frame [m].
    """
    x, y, _ = load.moment - np.cross(bush, load.force)
    return FootOffset(-x / compliance.roll, -y / compliance.pitch, -load.force[2] / compliance.vertical)
