"""Differences between the simulated plant and the controller's model of it."""

from dataclasses import dataclass

import mujoco

from sim.hardware.soles import BUSH_AXES, bush_joint
from sot.errors import InputError
from sot.robots.robot import Robot

VALUE_RANGES = {
    "mass": (0.1, 10.0),
    "damping": (0.0, 100.0),
    "gear_friction": (0.0, 0.5),
    "delay": (0.0, 0.1),
    "noise": (0.0, 10.0),
    "friction": (0.01, 0.7),
    "seed": (0, 2**32 - 1),
}
"""Least and greatest value of each number; no floor holds better than 0.7."""


@dataclass(frozen=True)
class Mismatch:
    """How robot, sensors and floor differ from the controller's model of them; nobody tells it.

    Attributes:
        mass: factor on every mass and inertia.
        damping: factor on every joint's viscous damping.
        gear_friction: Coulomb friction of every joint beside its model's, over its torque limit.
        delay: from a torque's command to its effect [s], to the nearest physics step.
        noise: standard deviation of what is added to every measured angular velocity, of joints and base, at each
            reading anew [rad/s].
        friction: coefficient of the floor.
        seed: of the noise.

    Raises:
        InputError: a number outside of what makes sense.
    """

    mass: float = 1.0
    damping: float = 1.0
    gear_friction: float = 0.0
    delay: float = 0.0
    noise: float = 0.0
    friction: float = 0.7
    seed: int = 0

    def __post_init__(self) -> None:
        for name, (low, high) in VALUE_RANGES.items():
            if not low <= getattr(self, name) <= high:
                raise InputError(f"mismatch {name}={getattr(self, name):g}: must be between {low:g} and {high:g}")

    def apply(self, model: mujoco.MjModel, robot: Robot) -> None:
        """Change masses and losses of a compiled model; bushes of feet are no joints of the robot."""
        if self.mass != 1.0:
            model.body_mass *= self.mass
            model.body_inertia *= self.mass
            mujoco.mj_setConst(model, mujoco.MjData(model))
        bushes = {bush_joint(foot, axis) for foot in robot.feet for axis in BUSH_AXES}
        for k in range(model.nv):
            if model.joint(model.dof_jntid[k]).name not in bushes:
                model.dof_damping[k] *= self.damping
        for name, effort in zip(robot.joints, robot.effort, strict=True):
            model.dof_frictionloss[model.joint(name).dofadr[0]] += self.gear_friction * effort


NO_MISMATCH = Mismatch()
"""The plant is as the controller knows it."""
