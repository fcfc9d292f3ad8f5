"""What is between a command and the joints, and between the robot and what is known of it: servos, soles, sensors."""

from sot.hardware.compliance import FootCompliance
from sot.hardware.hardware import Hardware
from sot.hardware.readings import Readings, measured_zmp
from sot.hardware.sensors import SENSOR_PRESETS, Channel, Sensors, sensor_preset
from sot.hardware.servo import JointTargets, Servo

__all__ = [
    "SENSOR_PRESETS",
    "Channel",
    "FootCompliance",
    "Hardware",
    "JointTargets",
    "Readings",
    "Sensors",
    "Servo",
    "measured_zmp",
    "sensor_preset",
]
