"""A humanoid robot: one model file (MJCF or URDF), and what the model leaves unnamed, from a text file beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.robots.fetch import Package, package_folder
from sot.robots.urdf import Urdf
from sot.toml_file import read_toml

MODELS = Path(__file__).parent / "models"
FEET = ("left_foot", "right_foot")
HANDS = ("left_hand", "right_hand")
SIDED = ("hip", "knee", "ankle", "foot", "shoulder", "elbow", "wrist", "hand")
POINTS = (
    *("waist", "chest", "neck", "head", "head_top"),
    *(f"{side}_{point}" for side in ("left", "right") for point in SIDED),
)
GROUPS = ("left_leg", "right_leg", "chest", "head", "left_arm", "right_arm")


def robot_names() -> tuple[str, ...]:
    """Names of the robots that come with the project."""
    return tuple(sorted(path.stem for path in MODELS.glob("*.toml")))


@dataclass(frozen=True, eq=False)
class Robot:
    """A humanoid, immutable. Arrays are read-only; joints are the `na` actuated ones in Pinocchio's order.

    Attributes:
        name: name of the robot file.
        label: what a reader should call the robot.
        path: model file, MJCF or URDF.
        mjcf: what MuJoCo reads instead of a URDF; None if the model file is an MJCF.
        model: Pinocchio model, its first joint the free base.
        joints: joint names (na).
        rest: rest configuration (nq,), the soles flat on z = 0.
        lower, upper: joint range (na,) [rad].
        velocity, acceleration, acceleration_hard, effort: symmetric limits (na,) [rad/s, rad/s², rad/s², N m];
            `acceleration` is for references and braking, `acceleration_hard` bounds a control tick.
        damping, friction, armature: viscous [N m s/rad] and Coulomb [N m] losses and reflected rotor inertia
            [kg m²] (na,); the armature is part of the model's mass matrix too, the losses of nothing.
        shapes: collision shapes, fixed to the model's joints; the model file's, primitives in the place of a URDF's
            meshes.
        points: operational point -> Pinocchio frame. `<side>_foot` lies on the sole, parallel to the world at rest.
        soles: foot -> contact vertices (nc, 3) in the foot frame [m].
        groups: joint group -> indices into the joints.
    """

    name: str
    label: str
    path: Path
    mjcf: str | None = field(repr=False)
    model: pin.Model = field(repr=False)
    joints: tuple[str, ...]
    rest: np.ndarray = field(repr=False)
    lower: np.ndarray = field(repr=False)
    upper: np.ndarray = field(repr=False)
    velocity: np.ndarray = field(repr=False)
    acceleration: np.ndarray = field(repr=False)
    acceleration_hard: np.ndarray = field(repr=False)
    effort: np.ndarray = field(repr=False)
    damping: np.ndarray = field(repr=False)
    friction: np.ndarray = field(repr=False)
    armature: np.ndarray = field(repr=False)
    shapes: pin.GeometryModel = field(repr=False)
    points: Mapping[str, int] = field(repr=False)
    soles: Mapping[str, np.ndarray] = field(repr=False)
    groups: Mapping[str, tuple[int, ...]] = field(repr=False)

    feet = FEET
    hands = HANDS

    @staticmethod
    def load(robot: str | Path) -> "Robot":
        """The robot of a name that `robot_names()` lists, or of a robot file (`.toml`).

        Raises:
            InputError: no such robot, or its file is incomplete or does not fit its model.
        """
        path = Path(robot)
        if path.suffix != ".toml":
            path = MODELS / f"{robot}.toml"
            if not path.is_file():
                known = ", ".join(robot_names())
                raise InputError(f"unknown robot '{robot}': choose one of {known}, or give a robot file (.toml)")
        return _load(path.resolve())

    @property
    def nq(self) -> int:
        return self.model.nq

    @property
    def nv(self) -> int:
        return self.model.nv

    @property
    def na(self) -> int:
        return self.model.nv - 6

    @property
    def mass(self) -> float:
        """Total mass [kg]."""
        return pin.computeTotalMass(self.model)

    def point(self, name: str) -> int:
        """Pinocchio frame of an operational point.

        Raises:
            InputError: the robot has no such point.
        """
        try:
            return self.points[name]
        except KeyError:
            known = ", ".join(self.points)
            raise InputError(f"{self.name} has no point '{name}': choose one of {known}") from None

    def sole(self, foot: str) -> np.ndarray:
        """Contact vertices (nc, 3) of a foot, in its frame [m].

        Raises:
            InputError: not a foot.
        """
        try:
            return self.soles[foot]
        except KeyError:
            raise InputError(f"{self.name} has no foot '{foot}': choose one of {', '.join(self.soles)}") from None

    def joint_numbers(self, joints: str | Sequence[str]) -> np.ndarray:
        """Numbers (n,) of the joints of a group, or of some that are named.

        Raises:
            InputError: the robot has no such group or joint.
        """
        if isinstance(joints, str):
            if joints not in self.groups:
                raise InputError(f"{self.name} has no joint group '{joints}': it has {', '.join(self.groups)}")
            return np.array(self.groups[joints])
        unknown = [name for name in joints if name not in self.joints]
        if unknown:
            raise InputError(f"{self.name} has no joint '{unknown[0]}': it has {', '.join(self.joints)}")
        return np.array([self.joints.index(name) for name in joints])


@lru_cache
def _load(path: Path) -> Robot:
    file = _RobotFile(path)
    model_path = _model_path(file)
    urdf = Urdf.read(model_path, file.locked()) if model_path.suffix == ".urdf" else None
    model = urdf.model if urdf else _read_mjcf(model_path)
    names = tuple(model.names)[2:]
    turning = all(joint.shortname().startswith("JointModelR") for joint in model.joints.tolist()[2:])
    if model.nq != 7 + len(names) or model.nv != 6 + len(names) or not turning:
        raise InputError(f"{model_path}: the model needs a free base, then joints that turn about one axis")
    points = _points(model, file)
    rest = _rest(model, names, file)
    soles = _soles(model, points, file)
    _put_soles_on_ground(model, rest, points, soles)
    if urdf:
        urdf = urdf.with_soles(
            {model.frames[points[foot]].parentJoint: _in_joint(model, points[foot], soles[foot]) for foot in FEET}
        )
    groups = {group: file.indices(names, group) for group in GROUPS}
    groups["legs"] = tuple(sorted(groups["left_leg"] + groups["right_leg"]))
    groups["arms"] = tuple(sorted(groups["left_arm"] + groups["right_arm"]))
    limits = {
        "lower": model.lowerPositionLimit[7:],
        "upper": model.upperPositionLimit[7:],
        "velocity": file.limit("velocity", names, model.upperVelocityLimit[6:]),
        "acceleration": file.limit("acceleration", names),
        "acceleration_hard": file.limit("acceleration_hard", names),
        "effort": file.limit("effort", names, model.upperEffortLimit[6:]),
        "damping": model.damping[6:],
        "friction": model.upperDryFrictionLimit[6:],
        "armature": model.armature[6:],
    }
    return Robot(
        name=path.stem,
        label=file.get("label", str),
        path=model_path,
        mjcf=urdf.mjcf(path.stem, rest) if urdf else None,
        model=model,
        joints=names,
        rest=_frozen(rest),
        shapes=urdf.shapes if urdf else pin.buildGeomFromMJCF(model, str(model_path), pin.GeometryType.COLLISION),
        points=MappingProxyType(points),
        soles=MappingProxyType({foot: _frozen(corners) for foot, corners in soles.items()}),
        groups=MappingProxyType(groups),
        **{name: _frozen(values) for name, values in limits.items()},
    )


class _RobotFile:
    """The text file, read with errors that say where they are."""

    def __init__(self, path: Path):
        self.path = path
        self.content = read_toml(path, "a robot file")

    def get(self, key: str, *kinds: type) -> Any:
        """Value of a dotted key, of one of the kinds."""
        value: Any = self.content
        for part in key.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        if value is None:
            raise InputError(f"{self.path}: '{key}' is missing")
        if not isinstance(value, kinds):
            raise InputError(f"{self.path}: '{key}' must be a {' or a '.join(kind.__name__ for kind in kinds)}")
        return value

    def by_joint(self, key: str, names: Sequence[str], table: dict[str, Any]) -> dict[int, float]:
        """A table joint -> number as index -> number."""
        for joint, value in table.items():
            if joint not in names:
                raise InputError(f"{self.path}: '{key}' names '{joint}', which is no joint of the model")
            if not isinstance(value, int | float):
                raise InputError(f"{self.path}: '{key}.{joint}' must be a number")
        return {names.index(joint): float(value) for joint, value in table.items()}

    def limit(self, name: str, names: Sequence[str], model: np.ndarray | None = None) -> np.ndarray:
        """A limit of every joint: the model's, overridden by a number for all or a table by joint; positive, finite."""
        values = np.full(len(names), np.inf) if model is None else model.copy()
        key = f"limits.{name}"
        if name in self.content.get("limits", {}) or model is None:
            given = self.get(key, float, int, dict)
            if isinstance(given, dict):
                for k, value in self.by_joint(key, names, given).items():
                    values[k] = value
            else:
                values[:] = given
        for joint, value in zip(names, values, strict=True):
            if not 0.0 < value < np.inf:
                raise InputError(f"{self.path}: '{key}' of joint '{joint}' is {value}: give it there, positive")
        return values

    def indices(self, names: Sequence[str], group: str) -> tuple[int, ...]:
        joints = self.get(f"groups.{group}", list)
        for joint in joints:
            if joint not in names:
                raise InputError(f"{self.path}: 'groups.{group}' names '{joint}', which is no joint of the model")
        return tuple(names.index(joint) for joint in joints)

    def locked(self) -> dict[str, float]:
        """Joints of a URDF that are no joints of the robot, with the angles they are held at [rad]."""
        locked = self.content.get("locked", {})
        if not isinstance(locked, dict) or not all(isinstance(angle, int | float) for angle in locked.values()):
            raise InputError(f"{self.path}: 'locked' must be a table of joints and their angles [rad]")
        return locked

    def vector(self, key: str, value: Any) -> np.ndarray:
        vector = np.array(value, dtype=object)
        if vector.shape != (3,) or not all(isinstance(v, int | float) for v in vector):
            raise InputError(f"{self.path}: '{key}' must be three numbers [m], not {value}")
        return vector.astype(float)

    def frame(self, key: str, model: pin.Model, name: Any) -> int:
        """Frame of a name; of a joint, its link and a site of one name, the last in the model (the most specific)."""
        ids = [k for k, frame in enumerate(model.frames) if frame.name == name]
        if not ids:
            raise InputError(f"{self.path}: '{key}' names the frame '{name}', which the model does not have")
        return ids[-1]


def _model_path(file: _RobotFile) -> Path:
    """The model file, beside the robot file or in the package that the robot file names."""
    model = file.get("model", str)
    if "package" in file.content:
        name, version, sha256 = (file.get(f"package.{key}", str) for key in ("name", "version", "sha256"))
        terms = "; ".join(file.get(f"package.{key}", str) for key in ("source", "licence"))
        path = package_folder(Package(name, version, sha256), terms) / model
        if not path.is_file():
            raise InputError(f"{file.path}: no file '{model}' in the package {name} {version}")
        return path
    path = file.path.parent / model
    if not path.is_file():
        raise InputError(f"{file.path}: no model file '{path.name}' beside it")
    return path


def _read_mjcf(path: Path) -> pin.Model:
    try:
        return pin.buildModelFromMJCF(str(path))
    except (ValueError, RuntimeError, IndexError) as error:
        raise InputError(f"{path}: Pinocchio cannot read it: {str(error).splitlines()[0]}") from None


def _points(model: pin.Model, file: _RobotFile) -> dict[str, int]:
    """Frames by point name: a frame of the model, or a position in one (the frame is then added to the model)."""
    points = {}
    for name, value in file.get("points", dict).items():
        key = f"points.{name}"
        if isinstance(value, dict):
            parent = model.frames[file.frame(key, model, value.get("frame"))]
            offset = pin.SE3(np.eye(3), file.vector(f"{key}.position", value.get("position")))
            frame = pin.Frame(name, parent.parentJoint, parent.placement * offset, pin.FrameType.OP_FRAME)
            points[name] = model.addFrame(frame)
        else:
            points[name] = file.frame(key, model, value)
    missing = [name for name in POINTS if name not in points]
    if missing:
        raise InputError(f"{file.path}: 'points' lacks {', '.join(missing)}")
    return points


def _soles(model: pin.Model, points: Mapping[str, int], file: _RobotFile) -> dict[str, np.ndarray]:
    """Sole corners in the foot frames, from frames of the foot's link or from positions in the foot frame."""
    soles = {}
    for foot in FEET:
        key = f"soles.{foot}"
        foot_frame = model.frames[points[foot]]
        corners = []
        for corner in file.get(key, list):
            if isinstance(corner, str):
                frame = model.frames[file.frame(key, model, corner)]
                if frame.parentJoint != foot_frame.parentJoint:
                    raise InputError(f"{file.path}: '{key}': the frame '{corner}' is on another link than the foot")
                corners.append(foot_frame.placement.actInv(frame.placement).translation)
            else:
                corners.append(file.vector(key, corner))
        if len(corners) < 3:
            raise InputError(f"{file.path}: '{key}' needs three corners or more")
        soles[foot] = np.array(corners)
    return soles


def _rest(model: pin.Model, names: Sequence[str], file: _RobotFile) -> np.ndarray:
    """Rest configuration: a key frame of the model, or a table of joint angles (the others zero)."""
    rest = file.get("rest", str, dict)
    if isinstance(rest, str):
        key_frames = {entry.key(): entry.data() for entry in model.referenceConfigurations}
        if rest not in key_frames:
            raise InputError(f"{file.path}: 'rest' names the key frame '{rest}', which the model does not have")
        return key_frames[rest].copy()
    q = pin.neutral(model)
    for k, angle in file.by_joint("rest", names, rest).items():
        q[7 + k] = angle
    return q


def _put_soles_on_ground(
    model: pin.Model, rest: np.ndarray, points: Mapping[str, int], soles: Mapping[str, np.ndarray]
) -> None:
    """Raise or lower the base so that the lowest sole corner is at z = 0."""
    data = model.createData()
    pin.framesForwardKinematics(model, data, rest)
    rest[2] -= min(data.oMf[points[foot]].act(corner)[2] for foot in FEET for corner in soles[foot])


def _in_joint(model: pin.Model, frame: int, corners: np.ndarray) -> np.ndarray:
    """Corners (n, 3) of a frame in the frame of its joint."""
    return np.array([model.frames[frame].placement.act(corner) for corner in corners])


def _frozen(array: np.ndarray) -> np.ndarray:
    array = np.array(array, dtype=float)
    array.setflags(write=False)
    return array
