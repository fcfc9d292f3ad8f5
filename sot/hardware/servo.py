"""Joint servos: what a position-controlled robot takes instead of torques, and the gains with which it follows."""

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from sot.gravity import GRAVITY
from sot.robots.robot import Robot

Array = np.ndarray

SUPPORT_STIFFNESS_RATIO = 50.0
"""Stiffness of the servos that hold the robot up, of legs and chest, over m g l: 20,000 N m/rad for 58 kg."""
FULL_TORQUE_ERROR = 0.0125
"""Error [rad] at which any other servo gives all of its motor's torque: 8,000 N m/rad for 100 N m."""
ROTOR_INERTIA_RATIO = 2e-4
"""Reflected rotor inertia over the torque limit [s²] of geared motors whose model gives none."""
LEG_COMMAND_RATE, UPPER_COMMAND_RATE = 200.0, 100.0
"""Rates at which servos of the legs and above them take commands [Hz]."""


@dataclass(frozen=True, slots=True)
class JointTargets:
    """What a position controller commands: where the joints are to be at the time of its tick, and how fast.

    Attributes:
        position: (na,) in the order of `Robot.joints` [rad].
        velocity: (na,) [rad/s]; servos use it to look one command period ahead, so it is the position's derivative.
    """

    position: Array
    velocity: Array


@dataclass(frozen=True, eq=False)
class Servo:
    """The servos of a robot: τ = kp (q_d − q) + kd (q̇_d − q̇) within the motors' torque limits.

    Each takes a command every period and reads it as q_d one period ahead, q + T q̇; between commands q_d moves in a
    straight line, and q̇_d is its slope.

    Attributes:
        stiffness: kp (na,) [N m/rad].
        damping: kd (na,) [N m s/rad].
        period: T between commands (na,) [s].
        rotor: inertia of the motors' rotors as the joints feel it (na,) [kg m²]; a model that gives none has these.
    """

    stiffness: Array = field(repr=False)
    damping: Array = field(repr=False)
    period: Array = field(repr=False)
    rotor: Array = field(repr=False)

    @staticmethod
    def of(robot: Robot) -> "Servo":
        """The servos of a robot: the gains of its file, else stiff enough for its weight, or for the motor above the
        chest, and the rotor alone critically damped."""
        stiffness, damping = robot.effort / FULL_TORQUE_ERROR, robot.servo["damping"]
        stiffness[[*robot.groups["legs"], *robot.groups["chest"]]] = SUPPORT_STIFFNESS_RATIO * _toppling_moment(robot)
        stiffness = np.where(np.isnan(robot.servo["stiffness"]), stiffness, robot.servo["stiffness"])
        rotor = np.where(robot.armature > 0.0, robot.armature, ROTOR_INERTIA_RATIO * robot.effort)
        period = np.full(robot.na, 1.0 / UPPER_COMMAND_RATE)
        period[list(robot.groups["legs"])] = 1.0 / LEG_COMMAND_RATE
        return Servo(stiffness, np.where(np.isnan(damping), 2.0 * np.sqrt(stiffness * rotor), damping), period, rotor)

    def scaled(self, stiffness: float) -> "Servo":
        """Servos whose stiffness is a factor larger, their rotors damped as well as before."""
        return Servo(stiffness * self.stiffness, np.sqrt(stiffness) * self.damping, self.period, self.rotor)


def _toppling_moment(robot: Robot) -> float:
    """m g l: what gravity has on the robot for each radian that it leans about its ankles [N m/rad]."""
    data = robot.model.createData()
    com = pin.centerOfMass(robot.model, data, robot.rest)
    pin.updateFramePlacements(robot.model, data)
    ankle = data.oMf[robot.point("left_ankle")].translation
    return robot.mass * GRAVITY * float(com[2] - ankle[2])
