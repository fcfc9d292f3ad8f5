"""The static deflection of compliant feet under their planned load, undone at the feet."""

import numpy as np

from sot.hardware.compliance import FootCompliance
from sot.rotation import cross
from sot.servo.load_sharing import FootLoad

Array = np.ndarray


def bush_compliance(compliance: FootCompliance) -> Array:
    """1 / K of roll, pitch [rad/(N m)] and height [m/N], shape (3,)."""
    return 1.0 / np.array([compliance.roll, compliance.pitch, compliance.vertical])


def sag_offset(load: FootLoad, compliance: Array, bush: Array) -> Array:
    """Roll, pitch and height (3,) that a foot is to be off by so that its load deflects it back to the plan [rad, m].

    The moment about the bush, M + (o − b) × F, turns the sole by M / K against the foot; as the sole lies flat, the
    foot turns by −M / K against the floor, and all of the robot with it. An upright pendulum multiplies that by
    K / (K − m g l). Turned by −M / K beforehand, the foot leaves the robot where it was meant to be.

    Args:
        load: planned, about the origin o of the foot frame.
        compliance: 1 / K, (3,), see `bush_compliance`.
        bush: its middle b (3,) in the foot frame [m].
    """
    x, y, _ = load.moment - cross(bush, load.force)
    return -compliance * np.array([x, y, load.force[2]])
