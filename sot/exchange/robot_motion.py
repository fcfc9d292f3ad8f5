"""A robot's motion as files of trackers and retargeters hold it: a configuration a frame, at a rate."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from sot.robots.robot import Robot

Array = NDArray[np.float64]

SAMPLE_TOLERANCE = 1e-9  # of a frame, that the last one of a resampled motion may lie beyond the end


@dataclass(frozen=True)
class LinkStates:
    """Links of a robot over time, in the order in which MuJoCo numbers them (depth first), frames as in the model file.

    Attributes:
        names: of the links (B).
        position: (T, B, 3) of their frames, world [m].
        rotation: (T, B, 4) quaternions xyzw, from the link to the world.
        linear, angular: (T, B, 3) velocities of their frames, world axes [m/s, rad/s].
    """

    names: tuple[str, ...]
    position: Array
    rotation: Array
    linear: Array
    angular: Array

    def taken(self, order: Array) -> "LinkStates":
        """Some of the links, in another order: indices into these."""
        names = tuple(self.names[k] for k in order)
        arrays = (self.position, self.rotation, self.linear, self.angular)
        return LinkStates(names, *(values[:, order] for values in arrays))


@dataclass(frozen=True, eq=False)
class RobotMotion:
    """A robot's motion.

    Attributes:
        robot: Who moves.
        name: Of the clip.
        rate: Frames per second [Hz].
        q: (T, nq) configurations in Pinocchio's conventions: root position [m], quaternion xyzw, joints [rad].
        v: (T, nv) velocities in Pinocchio's conventions: root in its own axes, linear and angular, then joints.
        torque: (T, na) of the joints [N m]; None where nobody knows it.
        contacts: (T, 2) whether the left and the right foot are on the floor; None where nobody knows it.
        facts: whose motion it is and how it was made, to be told in the licence card; plain text by what it tells.
    """

    robot: Robot
    name: str
    rate: float
    q: Array
    v: Array
    torque: Array | None = None
    contacts: NDArray[np.bool_] | None = None
    facts: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @staticmethod
    def of_configurations(robot: Robot, name: str, rate: float, q: Array) -> "RobotMotion":
        """The motion through configurations (T, nq); velocities are central differences."""
        return RobotMotion(robot, name, rate, q, velocities(robot, q, rate))

    @property
    def count(self) -> int:
        """Number of frames T."""
        return len(self.q)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.count - 1) / self.rate

    @property
    def root_position(self) -> Array:
        """(T, 3) of the base, world [m]."""
        return self.q[:, :3]

    @property
    def root_xyzw(self) -> Array:
        """(T, 4) quaternion xyzw of the base."""
        return self.q[:, 3:7]

    @property
    def root_wxyz(self) -> Array:
        """(T, 4) quaternion wxyz of the base."""
        return self.q[:, [6, 3, 4, 5]]

    @property
    def angles(self) -> Array:
        """(T, na) of the joints, in the order of `Robot.joints` [rad]."""
        return self.q[:, 7:]

    @property
    def joint_velocities(self) -> Array:
        """(T, na) of the joints [rad/s]."""
        return self.v[:, 6:]

    @property
    def root_velocity(self) -> tuple[Array, Array]:
        """(T, 3) linear and angular velocity of the base, both in world axes [m/s, rad/s]."""
        turn = Rotation.from_quat(self.root_xyzw)
        return turn.apply(self.v[:, :3]), turn.apply(self.v[:, 3:6])

    def part(self, start: float = 0.0, duration: float | None = None) -> "RobotMotion":
        """The frames of `duration` seconds from `start`, to the end by default; less where the motion ends before."""
        first = round(start * self.rate)
        last = self.count if duration is None else min(self.count, first + round(duration * self.rate) + 1)
        return replace(
            self,
            q=self.q[first:last],
            v=self.v[first:last],
            torque=None if self.torque is None else self.torque[first:last],
            contacts=None if self.contacts is None else self.contacts[first:last],
        )

    def resampled(self, rate: float) -> "RobotMotion":
        """The motion at another rate [Hz] from its first frame on: linear between frames, rotations on great arcs."""
        if rate == self.rate or self.count < 2:
            return replace(self, rate=rate)
        own = np.arange(self.count) / self.rate
        times = np.arange(int(self.duration * rate + SAMPLE_TOLERANCE) + 1) / rate
        times = np.minimum(times, own[-1])

        def between(values: Array) -> Array:
            place = np.minimum(times * self.rate, self.count - 1.0)
            before = np.minimum(place.astype(int), self.count - 2)
            share = (place - before)[:, None]
            mixed: Array = (1.0 - share) * values[before] + share * values[before + 1]
            return mixed

        q = between(self.q)
        q[:, 3:7] = Slerp(own, Rotation.from_quat(self.root_xyzw))(times).as_quat()
        nearest = np.round(times * self.rate).astype(int)
        return replace(
            self,
            rate=rate,
            q=q,
            v=between(self.v),
            torque=None if self.torque is None else between(self.torque),
            contacts=None if self.contacts is None else self.contacts[nearest],
        )

    @cached_property
    def links(self) -> LinkStates:
        """All links over time."""
        model, data, names = self.robot.model, self.robot.model.createData(), link_names(self.robot)
        frames = [model.getFrameId(name, pin.FrameType.BODY) for name in names]
        shape = (self.count, len(frames))
        position, rotation = np.empty((*shape, 3)), np.empty((*shape, 3, 3))
        velocity = np.empty((*shape, 6))
        for k in range(self.count):
            pin.forwardKinematics(model, data, self.q[k], self.v[k])
            pin.updateFramePlacements(model, data)
            for i, frame in enumerate(frames):
                place = data.oMf[frame]
                position[k, i], rotation[k, i] = place.translation, place.rotation
                velocity[k, i] = pin.getFrameVelocity(model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector
        quaternions = Rotation.from_matrix(rotation.reshape(-1, 3, 3)).as_quat(canonical=True).reshape(*shape, 4)
        return LinkStates(names, position, quaternions, velocity[..., :3], velocity[..., 3:])


def link_names(robot: Robot) -> tuple[str, ...]:
    """Names of a robot's links, every parent before its children, in MuJoCo's order (depth first)."""
    return tuple(link.name for link in robot.tree.links)


def velocities(robot: Robot, q: Array, rate: float) -> Array:
    """Velocities (T, nv) along configurations (T, nq) at a rate [Hz]: central differences, one-sided at both ends."""
    last = len(q) - 1
    if last < 1:
        return np.zeros((len(q), robot.nv))
    ends = [(max(k - 1, 0), min(k + 1, last)) for k in range(len(q))]
    # From the frame itself both ways: a difference is a velocity in the axes of the frame that it starts from.
    steps = [
        (pin.difference(robot.model, q[k], q[after]) - pin.difference(robot.model, q[k], q[before])) / (after - before)
        for k, (before, after) in enumerate(ends)
    ]
    return rate * np.array(steps)
