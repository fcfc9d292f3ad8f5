"""Hardware put into MuJoCo's specification of a robot."""

import mujoco

from sim.hardware.sensor_suite import add_sensors
from sim.hardware.servo_drive import add_servos
from sim.hardware.soles import add_bushes, tree_with_soles
from sot.hardware.hardware import Hardware
from sot.robots.robot import Robot


def robot_spec(robot: Robot, hardware: Hardware, timestep: float) -> mujoco.MjSpec:
    """The robot alone, without motors; with soles of their own if they are compliant or measured.

    Args:
        robot: the robot.
        hardware: what it has.
        timestep: of the physics [s].
    """
    if hardware.compliance is None and hardware.sensors is None:
        return robot.mujoco_spec()
    spec = tree_with_soles(robot).spec()
    if hardware.compliance is not None:
        add_bushes(spec, robot, hardware.compliance, timestep)
    return spec


def add_hardware(spec: mujoco.MjSpec, robot: Robot, hardware: Hardware) -> None:
    """Turn the motors into servos, and add sensors, as the hardware has them."""
    if hardware.servo is not None:
        add_servos(spec, robot, hardware.servo)
    if hardware.sensors is not None:
        add_sensors(spec, robot, hardware.sensors)
