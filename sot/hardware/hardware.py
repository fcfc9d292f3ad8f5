"""The hardware of a robot as one value."""

from dataclasses import dataclass

from sot.hardware.compliance import FootCompliance
from sot.hardware.sensors import Sensors
from sot.hardware.servo import Servo


@dataclass(frozen=True, eq=False)
class Hardware:
    """What a robot has beside links and motors.

    Attributes:
        servo: its joint servos; None where motors take torques.
        compliance: of its feet; None where soles are rigid.
        sensors: None where nobody reads any.
    """

    servo: Servo | None = None
    compliance: FootCompliance | None = None
    sensors: Sensors | None = None


TORQUE_DRIVEN = Hardware()
"""Ideal torque motors, rigid soles."""
