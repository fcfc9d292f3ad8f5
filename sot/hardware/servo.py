"""Joint servos: what a position-controlled robot takes instead of torques, and the gains with which it follows."""

from dataclasses import dataclass, field

import numpy as np

from sot.robots.robot import Robot

Array = np.ndarray

FULL_TORQUE_ERROR = 0.0125
"""Error [rad] at which a servo gives all of its motor's torque: 20,000 N m/rad for 250 N m."""
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
    """

    stiffness: Array = field(repr=False)
    damping: Array = field(repr=False)
    period: Array = field(repr=False)

    @staticmethod
    def of(robot: Robot) -> "Servo":
        """The servos of a robot: the gains of its file, else full torque at `FULL_TORQUE_ERROR`, and the rotor alone
        critically damped."""
        stiffness, damping = robot.servo["stiffness"], robot.servo["damping"]
        stiffness = np.where(np.isnan(stiffness), robot.effort / FULL_TORQUE_ERROR, stiffness)
        rotor = np.where(robot.armature > 0.0, robot.armature, ROTOR_INERTIA_RATIO * robot.effort)
        period = np.full(robot.na, 1.0 / UPPER_COMMAND_RATE)
        period[list(robot.groups["legs"])] = 1.0 / LEG_COMMAND_RATE
        return Servo(stiffness, np.where(np.isnan(damping), 2.0 * np.sqrt(stiffness * rotor), damping), period)

    def scaled(self, stiffness: float) -> "Servo":
        """Servos whose stiffness is a factor larger, their rotors damped as well as before."""
        return Servo(stiffness * self.stiffness, np.sqrt(stiffness) * self.damping, self.period)
