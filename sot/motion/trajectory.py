"""A robot motion over time, and the paths of the robot's points along it."""

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.array_file import array_names, read_arrays
from sot.control.pose import Pose
from sot.errors import InputError
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.footfalls import Footfalls
from sot.motion.footing import footing_on
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface

Array = NDArray[np.float64]

SAMPLE_TOLERANCE = 1e-6
"""Distance from a sample, as a share of the sampling period, within which a time counts as that sample's."""
SAVED_FIELDS = ("q", "v", "a", "com", "com_velocity", "com_acceleration", "zmp", "momentum")
_NEEDED = {"robot", "joints", "rate", "phase_times", "phase_stands", "phase_slides", "phase_feet", *SAVED_FIELDS}


class MotionSample(NamedTuple):
    """A motion at one time; the fields are those of `Motion`."""

    q: Array
    v: Array
    a: Array
    com: Array
    com_velocity: Array
    com_acceleration: Array
    zmp: Array


class Reference(Protocol):
    """What a stack and a run ask of a robot's motion; a `Motion` answers, and so does one that arrives live."""

    @property
    def robot(self) -> Robot:
        """Who moves."""
        ...

    @property
    def duration(self) -> float:
        """How long it lasts [s], infinite if that is not known."""
        ...

    def sample(self, t: float) -> MotionSample:
        """The motion at a time [s]."""
        ...

    def joints(self, t: float) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of the joints at a time [s], (na,) each."""
        ...

    def balance(self, t: float) -> tuple[Array, Array, Array, Array]:
        """CoM (3,), its velocity and acceleration, and the ZMP (2,) at a time [s]."""
        ...

    def angular_momentum(self, t: float) -> Array:
        """Angular momentum about the centre of mass at a time [s], (3,), world axes [N m s]."""
        ...

    @property
    def feet(self) -> Mapping[str, Callable[[float], Array]]:
        """Function of each foot that gives its foothold (3,) [m] at a time [s]."""
        ...

    def pose(self, point: str) -> Callable[[float], Pose]:
        """An operational point's reference: its pose, velocity and acceleration at any time [s]."""
        ...


@dataclass(frozen=True)
class Track:
    """Path of a robot point: `position` (T, 3) and `rotation` (T, 3, 3) in the world; `velocity` and `acceleration`
    (T, 6), linear over angular, of the point in world axes (the acceleration is the classical one: ẍ of the point)."""

    position: Array
    rotation: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion of a robot, at rest at both ends.

    Attributes:
        robot: who moves.
        rate: samples per second [Hz].
        q, v, a: (T, nq), (T, nv), (T, nv) in Pinocchio's conventions; v and a are the derivatives of q.
        com, com_velocity, com_acceleration: (T, 3) centre of mass, world [m, m/s, m/s²].
        zmp: (T, 2) planned zero moment point on the floor [m].
        momentum: (T, 3) angular momentum about the centre of mass, world axes [N m s].
        phases: which feet stand where, in order of time.
    """

    robot: Robot
    rate: float
    q: Array
    v: Array
    a: Array
    com: Array
    com_velocity: Array
    com_acceleration: Array
    zmp: Array
    momentum: Array
    phases: tuple[Phase, ...]
    _tracks: dict[str, Track] = field(default_factory=dict, init=False, repr=False)
    _table: Array = field(init=False, repr=False)
    _slices: list[slice] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        parts = [getattr(self, name) for name in MotionSample._fields]
        edges = np.cumsum([0] + [part.shape[1] for part in parts])
        object.__setattr__(self, "_table", np.ascontiguousarray(np.hstack(parts)))
        object.__setattr__(self, "_slices", [slice(a, b) for a, b in itertools.pairwise(edges)])

    @staticmethod
    def standing(
        robot: Robot, seconds: float, rate: float = 1000.0, on: Mapping[str, Surface] | None = None
    ) -> "Motion":
        """A robot that stands still in its rest posture, on all feet.

        Args:
            robot: who stands.
            seconds: how long.
            rate: samples per second [Hz].
            on: foot -> surface of the world under it, a block's or a slope's, that it is moved up or down to; the legs
                bend as they must. The floor unless given.

        Raises:
            InputError: that is not even one step of the rate, or the legs do not reach these surfaces.
        """
        count = round(seconds * rate) + 1
        if not (0.0 < rate < np.inf and count > 1):
            raise InputError(f"a motion of {seconds:g} s at {rate:g} Hz has no two samples")
        q, phases = robot.rest, planted_phases(robot, (count - 1) / rate)
        if on:
            q, feet, reached = footing_on(robot, on)
            if not reached:
                names = ", ".join(f"{foot} on {surface.name}" for foot, surface in on.items())
                raise InputError(f"{robot.label} cannot stand with {names}: its legs do not reach")
            phases = tuple(replace(phase, feet=dict(feet), surfaces=dict(on)) for phase in phases)
        com = pin.centerOfMass(robot.model, robot.model.createData(), q).copy()
        still, nothing = np.zeros((count, robot.nv)), np.zeros((count, 3))
        return Motion(
            robot=robot,
            rate=rate,
            q=np.tile(q, (count, 1)),
            v=still,
            a=still,
            com=np.tile(com, (count, 1)),
            com_velocity=nothing,
            com_acceleration=nothing,
            zmp=np.tile(com[:2], (count, 1)),
            momentum=nothing,
            phases=phases,
        )

    def placed(self, x: float, y: float, yaw: float) -> "Motion":
        """The same motion elsewhere on the floor: turned about the origin by an angle [rad], then shifted [m].

        Raises:
            InputError: feet stand on blocks, slopes or stairs, which do not move along.
        """
        self._check_on_floor("placed elsewhere")
        place = pin.SE3(pin.utils.rotate("z", yaw), np.array([x, y, 0.0]))
        turn, q = place.rotation, self.q.copy()
        q[:, :3] = q[:, :3] @ turn.T + place.translation
        q[:, 3:7] = (Rotation.from_matrix(turn) * Rotation.from_quat(q[:, 3:7])).as_quat()
        vectors = ("com_velocity", "com_acceleration", "momentum")
        phases = [replace(one, feet={foot: place * at for foot, at in one.feet.items()}) for one in self.phases]
        return replace(
            self,
            q=q,
            com=self.com @ turn.T + place.translation,
            zmp=self.zmp @ turn[:2, :2].T + place.translation[:2],
            phases=tuple(phases),
            **{name: getattr(self, name) @ turn.T for name in vectors},
        )

    @property
    def times(self) -> Array:
        """(T,) from zero [s]."""
        return np.arange(len(self.q)) / self.rate

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return (len(self.q) - 1) / self.rate

    def sample(self, t: float) -> MotionSample:
        """The motion at a time [s], linear between samples, at rest before the first and after the last."""
        row = self._interpolated_row(t)
        return MotionSample._make([row[part] for part in self._slices])

    def _interpolated_row(self, t: float) -> Array:
        k, rest = self._sample_before(t)
        row = self._table[k]
        return row + rest * (self._table[k + 1] - row) if rest else row

    def _sample_before(self, t: float) -> tuple[int, float]:
        """Index of the sample at or before a time [s], and the share of the period that has passed since."""
        x, last = t * self.rate, len(self._table) - 1.0
        x = 0.0 if x < 0.0 else last if x > last else x
        k = int(x + SAMPLE_TOLERANCE)
        return (k, x - k) if x - k > SAMPLE_TOLERANCE else (k, 0.0)

    def joints(self, t: float) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of the joints at a time [s], (na,) each: a posture's reference."""
        row, (q, v, a, *_) = self._interpolated_row(t), self._slices
        return row[q.start + 7 : q.stop], row[v.start + 6 : v.stop], row[a.start + 6 : a.stop]

    def balance(self, t: float) -> tuple[Array, Array, Array, Array]:
        """CoM (3,), its velocity and acceleration, and the ZMP (2,) at a time [s]: a balance task's reference."""
        row, (_, _, _, com, velocity, acceleration, zmp) = self._interpolated_row(t), self._slices
        return row[com], row[velocity], row[acceleration], row[zmp]

    def angular_momentum(self, t: float) -> Array:
        """Angular momentum about the centre of mass at a time [s], (3,), world axes [N m s]."""
        k, rest = self._sample_before(t)
        L = self.momentum[k]
        return L + rest * (self.momentum[k + 1] - L) if rest else L

    @property
    def feet(self) -> dict[str, Callable[[float], Array]]:
        """Function of each foot that gives its foothold (3,) [m] at a time [s]; during a swing, the nearest in time."""
        return {foot: self._foothold(foot) for foot in self.robot.feet}

    def _foothold(self, foot: str) -> Callable[[float], Array]:
        stances, somewhere = Footfalls(self.phases, foot), np.full(3, np.nan)

        def at(t: float) -> Array:
            stance = stances.nearest_stance(t)
            return somewhere if stance is None else stance.pose.translation

        return at

    def pose(self, point: str) -> Callable[[float], Pose]:
        """An operational point's reference: its pose, velocity and acceleration at any time [s].

        Raises:
            InputError: the robot has no such point.
        """
        track = self.track(point)

        def at(t: float) -> Pose:
            k, rest = self._sample_before(t)
            dt = rest / self.rate
            pose = Pose(track.position[k], track.rotation[k], track.velocity[k], track.acceleration[k])
            if not dt:
                return pose
            turn = pin.exp3(dt * pose.velocity[3:])
            velocity = pose.velocity + dt * pose.acceleration
            return Pose(pose.position + dt * pose.velocity[:3], turn @ pose.rotation, velocity, pose.acceleration)

        return at

    def track(self, point: str) -> Track:
        """The path of an operational point of the robot, computed once.

        Raises:
            InputError: the robot has no such point.
        """
        if point not in self._tracks:
            self._tracks[point] = self._track_of_frame(self.robot.point(point))
        return self._tracks[point]

    def _track_of_frame(self, frame: int) -> Track:
        model, data, axes = self.robot.model, self.robot.model.createData(), pin.LOCAL_WORLD_ALIGNED
        length = len(self.q)
        track = Track(np.empty((length, 3)), np.empty((length, 3, 3)), np.empty((length, 6)), np.empty((length, 6)))
        for k in range(length):
            pin.forwardKinematics(model, data, self.q[k], self.v[k], self.a[k])
            pose = pin.updateFramePlacement(model, data, frame)
            track.position[k], track.rotation[k] = pose.translation, pose.rotation
            track.velocity[k] = pin.getFrameVelocity(model, data, frame, axes).vector
            track.acceleration[k] = pin.getFrameClassicalAcceleration(model, data, frame, axes).vector
        return track

    def save(self, path: str | Path) -> None:
        """Write to an `.npz` file.

        Raises:
            InputError: feet stand on blocks, slopes or stairs, of which a motion file knows nothing.
        """
        self._check_on_floor("saved")
        phases = {
            "phase_times": np.array([(phase.start, phase.end) for phase in self.phases]),
            "phase_stands": np.array([[foot in phase.feet for foot in self.robot.feet] for phase in self.phases]),
            "phase_slides": np.array([[foot in phase.sliding for foot in self.robot.feet] for phase in self.phases]),
            "phase_rises": np.array([[foot in phase.rising for foot in self.robot.feet] for phase in self.phases]),
            "phase_feet": np.array(
                [
                    [phase.feet.get(foot, pin.SE3.Identity()).homogeneous for foot in self.robot.feet]
                    for phase in self.phases
                ]
            ),
        }
        content: dict[str, Any] = {name: getattr(self, name) for name in SAVED_FIELDS} | phases
        np.savez_compressed(path, robot=self.robot.name, joints=self.robot.joints, rate=self.rate, **content)

    def _check_on_floor(self, done: str) -> None:
        names = sorted({on.name for phase in self.phases for on in phase.surfaces.values() if on.name != FLOOR.name})
        if names:
            raise InputError(f"a motion of feet on {', '.join(names)} cannot be {done}: only one on the floor can")

    @staticmethod
    def load(path: str | Path, robot: Robot | None = None) -> "Motion":
        """Read what `save` wrote; the robot is loaded by its name unless given.

        Raises:
            InputError: not a motion file, damaged, or of another robot.
        """
        content = _read_arrays(Path(path))
        name = str(content["robot"])
        robot = Robot.load(name) if robot is None else robot
        if tuple(content["joints"]) != robot.joints:
            raise InputError(f"{path}: a motion of the robot '{name}', whose joints are not those of '{robot.name}'")
        columns = _checked_columns(Path(path), content, robot)
        return Motion(robot, float(content["rate"]), **columns, phases=_checked_phases(Path(path), content, robot))


def is_motion_file(path: Path) -> bool:
    """Whether a file holds a motion that `Motion.save` wrote, whole or not."""
    return not _NEEDED.isdisjoint(array_names(path))


def _read_arrays(path: Path) -> Mapping[str, Array]:
    arrays = read_arrays(path, "a motion")
    if missing := sorted(_NEEDED - set(arrays)):
        raise InputError(f"{path}: not a motion file, it lacks {', '.join(missing)}")
    return arrays


def _checked_columns(path: Path, content: Mapping[str, Array], robot: Robot) -> dict[str, Array]:
    widths = (robot.nq, robot.nv, robot.nv, 3, 3, 3, 2, 3)
    length = len(np.atleast_1d(content["q"]))
    if length < 2 or content["rate"].shape != () or not 0.0 < float(content["rate"]) < np.inf:
        raise InputError(f"{path}: needs two samples or more and a positive rate")
    for name, width in zip(SAVED_FIELDS, widths, strict=True):
        values = content[name]
        if values.shape != (length, width):
            raise InputError(f"{path}: '{name}' has shape {values.shape}, expected {(length, width)}")
        if values.dtype.kind != "f" or not np.isfinite(values).all():
            raise InputError(f"{path}: '{name}' holds something that is not a finite number")
    return {name: content[name] for name in SAVED_FIELDS}


def _checked_phases(path: Path, content: Mapping[str, Array], robot: Robot) -> tuple[Phase, ...]:
    times, stands, slides, feet = (content[f"phase_{name}"] for name in ("times", "stands", "slides", "feet"))
    rises = content.get("phase_rises", np.zeros_like(slides))  # older files have none
    count, sides = len(np.atleast_1d(times)), len(robot.feet)
    shapes = (count, 2), (count, sides), (count, sides), (count, sides), (count, sides, 4, 4)
    if count < 1 or (times.shape, stands.shape, slides.shape, rises.shape, feet.shape) != shapes:
        raise InputError(f"{path}: its contact phases have wrong shapes")
    return tuple(
        Phase(
            float(start),
            float(end),
            {foot: pin.SE3(pose) for foot, pose, on in zip(robot.feet, poses, standing, strict=True) if on},
            tuple(foot for foot, on in zip(robot.feet, sliding, strict=True) if on),
            rising=tuple(foot for foot, up in zip(robot.feet, rising, strict=True) if up),
        )
        for (start, end), standing, sliding, rising, poses in zip(times, stands, slides, rises, feet, strict=True)
    )
