"""The text file of a robot: what a humanoid needs named and its model leaves unnamed."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sot.errors import InputError
from sot.robots.fetch import Package, package_folder
from sot.robots.surface import Surface
from sot.robots.surface_table import read_surfaces
from sot.toml_file import is_number, nearest, read_toml

FEET = ("left_foot", "right_foot")
SIDED = ("hip", "knee", "ankle", "foot", "shoulder", "elbow", "wrist", "hand")
POINTS = (
    *("waist", "chest", "neck", "head", "head_top"),
    *(f"{side}_{point}" for side in ("left", "right") for point in SIDED),
)
GROUPS = ("left_leg", "right_leg", "chest", "head", "left_arm", "right_arm")
LIMITS = ("lower", "upper", "velocity", "acceleration", "acceleration_hard", "effort")
DYNAMICS = ("armature", "damping", "friction")
SERVO = ("stiffness", "damping")
KEYS = {
    "": (
        "label",
        "listed",
        "model",
        "package",
        "locked",
        "rest",
        "points",
        "soles",
        "surfaces",
        "groups",
        "limits",
        "servo",
    ),
    "listed": ("joints", "mass", "height"),
    "package": ("name", "version", "sha256", "source", "licence"),
    "soles": FEET,
    "groups": GROUPS,
    "limits": (*LIMITS, *DYNAMICS),
    "servo": SERVO,
}


class RobotFile:
    """A robot file.

    Args:
        path: of the file.

    Raises:
        InputError: it cannot be read, or has a key that no robot file has.
    """

    def __init__(self, path: Path):
        self.path = path
        self.content = read_toml(path, "a robot file")
        for table, keys in KEYS.items():
            given = self.content.get(table, {}) if table else self.content
            if isinstance(given, dict):
                self._refuse_unknown(given, keys, f"{table}." if table else "")

    def error(self, message: str) -> InputError:
        """An error that says where it is."""
        return InputError(f"{self.path}: {message}")

    def get(self, key: str, *kinds: type) -> Any:
        """Value of a dotted key, of one of the kinds.

        Raises:
            InputError: it is missing or of another kind.
        """
        value: Any = self.content
        for part in key.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        if value is None:
            raise self.error(f"'{key}' is missing")
        if not isinstance(value, kinds) or isinstance(value, bool):
            raise self.error(f"'{key}' must be a {' or a '.join(kind.__name__ for kind in kinds)}")
        return value

    def model_path(self) -> Path:
        """The model file, beside the robot file or in the package that the robot file names.

        Raises:
            InputError: there is no such file, or the package cannot be fetched.
        """
        model = self.get("model", str)
        if "package" in self.content:
            name, version, sha256 = (self.get(f"package.{key}", str) for key in ("name", "version", "sha256"))
            terms = "; ".join(self.get(f"package.{key}", str) for key in ("source", "licence"))
            path = package_folder(Package(name, version, sha256), terms) / model
            if not path.is_file():
                raise self.error(f"no file '{model}' in the package {name} {version}")
            return path
        path = self.path.parent / model
        if not path.is_file():
            raise self.error(f"no model file '{path.name}' beside it")
        return path

    def locked(self) -> dict[str, float]:
        """Joints of the model that are no joints of the robot, with the angles [rad] or places [m] they are held at."""
        locked = self.content.get("locked", {})
        if not isinstance(locked, dict) or not all(is_number(angle) for angle in locked.values()):
            raise self.error("'locked' must be a table of joints and their angles [rad]")
        return {joint: float(angle) for joint, angle in locked.items()}

    def by_joint(self, key: str, joints: Sequence[str], table: Mapping[str, Any]) -> dict[str, float]:
        """A table joint -> number, checked."""
        for joint, value in table.items():
            if joint not in joints:
                raise self.error(f"'{key}' names '{joint}', which is no joint of the robot{nearest(joint, joints)}")
            if not is_number(value):
                raise self.error(f"'{key}.{joint}' must be a number, not {value}")
        return {joint: float(value) for joint, value in table.items()}

    def limit(self, name: str, joints: Sequence[str]) -> dict[str, float]:
        """What the file says of a limit: joint -> number, from one number for all or a table by joint."""
        return self._number_by_joint("limits", name, joints)

    def servo(self, name: str, joints: Sequence[str]) -> dict[str, float]:
        """What the file says of a gain of the joints' servos, likewise; it is positive."""
        gains = self._number_by_joint("servo", name, joints)
        for joint, gain in gains.items():
            if not gain > 0.0:
                raise self.error(f"'servo.{name}' of joint '{joint}' is {gain:g}: it must be positive")
        return gains

    def _number_by_joint(self, table: str, name: str, joints: Sequence[str]) -> dict[str, float]:
        entries = self.content.get(table, {})
        if not isinstance(entries, dict):
            raise self.error(f"'{table}' must be a table")
        given = entries.get(name, {})
        if is_number(given):
            return dict.fromkeys(joints, float(given))
        if not isinstance(given, dict):
            raise self.error(f"'{table}.{name}' must be a number for all joints or a table by joint, not {given}")
        return self.by_joint(f"{table}.{name}", joints, given)

    def groups(self, joints: Sequence[str]) -> dict[str, tuple[int, ...]]:
        """Group -> numbers of its joints; no joint is in two groups."""
        groups: dict[str, tuple[int, ...]] = {}
        owner: dict[str, str] = {}
        for group in GROUPS:
            key = f"groups.{group}"
            names = self.get(key, list)
            for joint in names:
                if joint not in joints:
                    raise self.error(f"'{key}' names '{joint}', which is no joint of the robot{nearest(joint, joints)}")
                if joint in owner:
                    raise self.error(f"'{key}' names '{joint}', which is in '{owner[joint]}' already")
                owner[joint] = group
            groups[group] = tuple(joints.index(joint) for joint in names)
        for side in ("left", "right"):
            if not groups[f"{side}_leg"]:
                raise self.error(f"'groups.{side}_leg' is empty: a robot needs two legs")
        return groups

    def points(self) -> dict[str, tuple[str, np.ndarray]]:
        """Point -> a frame of the model and a position in it (3,) [m]."""
        points = {}
        for name, value in self.get("points", dict).items():
            key = f"points.{name}"
            if isinstance(value, dict):
                self._refuse_unknown(value, ("frame", "position"), f"{key}.")
                frame = self.get(f"{key}.frame", str)
                points[name] = (frame, self.vector(f"{key}.position", value.get("position")))
            else:
                points[name] = (self.get(key, str), np.zeros(3))
        missing = [name for name in POINTS if name not in points]
        if missing:
            extra = [name for name in points if name not in POINTS]
            raise self.error(f"'points' lacks {', '.join(missing)}{nearest(missing[0], extra, 'is it')}")
        return points

    def corners(self, foot: str) -> list[str | np.ndarray]:
        """Corners of a sole: names of frames, or positions in the foot's frame (3,) [m]."""
        key = f"soles.{foot}"
        corners = [c if isinstance(c, str) else self.vector(key, c) for c in self.get(key, list)]
        if len(corners) < 3:
            raise self.error(f"'{key}' needs three corners or more")
        return corners

    def surfaces(self) -> dict[str, Surface]:
        """Surfaces beside the soles: name -> corners in the frame of one of the robot's points, and friction."""
        return read_surfaces(self.path, self.content.get("surfaces", {}), tuple(self.get("points", dict)))

    def vector(self, key: str, value: Any) -> np.ndarray:
        """Three numbers (3,)."""
        if not isinstance(value, list) or len(value) != 3 or not all(is_number(v) for v in value):
            raise self.error(f"'{key}' must be three numbers [m], not {value}")
        return np.array(value, dtype=float)

    def _refuse_unknown(self, table: Mapping[str, Any], known: Sequence[str], prefix: str) -> None:
        for key in table:
            if key not in known:
                raise self.error(f"no robot file has '{prefix}{key}'{nearest(key, known)}: {', '.join(known)}")
