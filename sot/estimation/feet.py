"""What a robot's joints and force sensors say of its feet: where the soles are, and what they carry."""

from math import exp, isfinite

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.estimation.filter_step import SeenFeet
from sot.gravity import GRAVITY
from sot.hardware.compliance import SOLE_MASS_SHARE, FootCompliance, bush_position
from sot.hardware.readings import Readings
from sot.robots.robot import Robot
from sot.rotation import cross, product, rotated, rotation_of_vector

Array = np.ndarray


def leg_length(robot: Robot) -> float:
    """Height of the hips over the soles at rest [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    return float(data.oMf[robot.point("left_hip")].translation[2])


class MeasuredFeet:
    """Soles as seen from the inertial unit, and the robot's base, of each instant's readings.

    Args:
        robot: whose feet.
        imu_point: operational point that the inertial unit is at.
        compliance: of the feet, if they have bushes between ankle and sole.

    Attributes:
        seen: the soles, in the order of `Robot.feet`.
        unit_in_base: rotation (3, 3) and position (3,) of the unit in the base, all joints as they are read.
        unit_moves: whether joints are between base and unit.
    """

    def __init__(self, robot: Robot, imu_point: str, compliance: FootCompliance | None = None) -> None:
        self._robot, self._data = robot, robot.model.createData()
        self._imu, self._frames = robot.point(imu_point), [robot.point(foot) for foot in robot.feet]
        self._q, self._v = pin.neutral(robot.model), np.zeros(robot.nv)
        self.seen = SeenFeet.empty(len(robot.feet))
        self.seen.own_weight[:] = [
            SOLE_MASS_SHARE * GRAVITY * robot.model.inertias[robot.model.frames[frame].parentJoint].mass
            for frame in self._frames
        ]
        self._bushes = None if compliance is None else [Bush(robot, foot, compliance) for foot in robot.feet]
        self.unit_moves = robot.model.frames[self._imu].parentJoint != 1

    def update(self, readings: Readings, passed: float) -> None:
        """Take in readings, a time [s] after the last ones."""
        model, data, seen = self._robot.model, self._data, self.seen
        self._q[7:], self._v[6:] = readings.joint_position, readings.joint_velocity
        if self.unit_moves:
            pin.forwardKinematics(model, data, self._q, self._v)
        else:
            pin.forwardKinematics(model, data, self._q)
        unit = pin.updateFramePlacement(model, data, self._imu)
        self.unit_in_base = unit.rotation.copy(), unit.translation.copy()
        for k, (foot, frame) in enumerate(zip(self._robot.feet, self._frames, strict=True)):
            sole, wrench = unit.actInv(pin.updateFramePlacement(model, data, frame)), readings.foot_wrench[foot]
            seen.position[k], seen.rotation[k], seen.force[k] = sole.translation, sole.rotation, wrench[:3]
            if self._bushes is not None:
                self._bushes[k].lower(seen.position[k], seen.rotation[k], wrench, passed)

    def unit_velocity_by_joints(self) -> Array:
        """Velocity (6,) that the joints give the inertial unit against the base, of the base's origin and axes."""
        moved = pin.getFrameVelocity(self._robot.model, self._data, self._imu, pin.LOCAL)
        return np.asarray(self._data.oMf[self._imu].act(moved).vector)

    def unit_state(self, q: Array, v: Array) -> tuple[pin.SE3, Array]:
        """Pose of the inertial unit in the world, and the velocity of its origin in world axes, of a state."""
        model, data = self._robot.model, self._robot.model.createData()
        pin.forwardKinematics(model, data, q, v)
        pose = pin.updateFramePlacement(model, data, self._imu)
        return pose.copy(), pin.getFrameVelocity(model, data, self._imu, pin.LOCAL_WORLD_ALIGNED).linear.copy()


class Bush:
    """How far a sole gives way against its foot, from the force above it: moment = K (δ + τ δ̇).

    Args:
        robot: the robot.
        foot: whose bush.
        compliance: its stiffness, and its damping over that, τ.
    """

    def __init__(self, robot: Robot, foot: str, compliance: FootCompliance) -> None:
        self._at = bush_position(robot, foot)
        stiffness = np.array([compliance.roll, compliance.pitch, compliance.vertical])
        self._per_load = np.array([1.0 / k if isfinite(k) else 0.0 for k in stiffness])
        self._relaxation = compliance.relaxation_time(robot)
        self.deflection = np.zeros(3)
        """Roll, pitch [rad] and height [m] of the sole."""

    def lower(self, position: Array, rotation: Array, wrench: Array, passed: float) -> None:
        """Make the pose of a foot, in any frame, that of its sole: (3,) and (3, 3), which are changed.

        Args:
            position, rotation: of the foot's frame as it is without load [m].
            wrench: of sole on foot (6,), see `Readings.foot_wrench` [N, N m].
            passed: since the last reading [s].
        """
        kept = exp(-passed / self._relaxation) if self._relaxation else 0.0
        _lower(position, rotation, self.deflection, self._at, self._per_load, wrench, kept)


@compiled
def _lower(
    position: Array, rotation: Array, deflection: Array, at: Array, per_load: Array, wrench: Array, kept: float
) -> None:
    """Turn and shift a foot's pose by its bush, whose deflection settles but for the share that is kept."""
    moment = wrench[3:] - cross(at, wrench[:3])
    for i, load in enumerate((moment[0], moment[1], wrench[2])):
        settled = per_load[i] * load
        deflection[i] = settled + kept * (deflection[i] - settled)
    turn = product(
        rotation_of_vector(np.array((deflection[0], 0.0, 0.0))), rotation_of_vector(np.array((0.0, deflection[1], 0.0)))
    )
    shift = at - rotated(turn, at)
    shift[2] += deflection[2]
    position += rotated(rotation, shift)
    rotation[:] = product(rotation, turn)
