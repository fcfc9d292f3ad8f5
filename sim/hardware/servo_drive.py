"""Joint servos in MuJoCo: the motors' own torque limits, with a position and a rate in front of them."""

from math import ceil

import mujoco
import numpy as np

from sot.hardware.servo import JointTargets, Servo
from sot.robots.robot import Robot

Array = np.ndarray


def add_servos(spec: mujoco.MjSpec, robot: Robot, servo: Servo) -> None:
    """Turn the motors of a robot into servos: force = ctrl − kp q − kd q̇, within the same limits.

    MuJoCo's integrator then knows kd: links that are light against h kd do not shake. Its contacts do not: without
    rotors, which kd is made for, the feet of a robot are so light to them that they rattle on the floor.
    """
    for k, name in enumerate(robot.joints):
        stiffness, damping = servo.stiffness[k], servo.damping[k]
        spec.joint(name).armature = servo.rotor[k]
        motor = spec.actuator(name)
        motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        motor.biasprm[1], motor.biasprm[2] = -stiffness, -damping
        motor.forcerange, motor.forcelimited = motor.ctrlrange, mujoco.mjtLimited.mjLIMITED_TRUE
        motor.ctrllimited = mujoco.mjtLimited.mjLIMITED_FALSE


class ServoDrive:
    """What the servos follow from physics step to physics step: straight lines between commands.

    Args:
        servo: the servos.
        timestep: of the physics [s].

    Attributes:
        position, velocity: q_d and q̇_d of the last physics step (na,) [rad, rad/s].
    """

    def __init__(self, servo: Servo, timestep: float) -> None:
        self._servo, self._timestep = servo, timestep
        self._steps_between = np.array([max(1, ceil(period / timestep - 1e-6)) for period in servo.period])
        self.reset()

    def reset(self) -> None:
        """Forget all commands."""
        self._step = self._age = 0
        self._targets: JointTargets | None = None
        self._end: Array | None = None
        self.position = self.velocity = np.full(len(self._steps_between), np.nan)

    def holding(self, position: Array, velocity: Array) -> Array:
        """What the motors are given where they are to give no torque at a position and velocity (na,)."""
        drive: Array = self._servo.stiffness * position + self._servo.damping * velocity
        return drive

    def __call__(self, targets: JointTargets) -> Array:
        """What the motors of `add_servos` are given in the next physics step: kp q_d + kd q̇_d (na,) [N m]."""
        # A tick's targets are of its first physics step; a servo may take them in a later one.
        self._age = self._age + 1 if targets is self._targets else 0
        self._targets = targets
        passed = self._step % self._steps_between
        if self._end is None:
            self._start, self._end, self.velocity = targets.position, targets.position, targets.velocity
        taken = passed == 0
        if taken.any():
            span = self._steps_between * self._timestep
            ahead = targets.position + (self._age * self._timestep + span) * targets.velocity
            self._start = np.where(taken, self._end, self._start)
            self._end = np.where(taken, ahead, self._end)
            self.velocity = np.where(taken, (self._end - self._start) / span, self.velocity)
        self.position = self._start + (passed * self._timestep) * self.velocity
        self._step += 1
        return self.holding(self.position, self.velocity)
