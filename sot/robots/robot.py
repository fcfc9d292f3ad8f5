"""A humanoid robot: one model file (MJCF or URDF), and what the model leaves unnamed, from a text file beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType

import mujoco
import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.read_only import read_only
from sot.robots.limits import joint_limits, remark_on_groups, with_limits
from sot.robots.pairs import collision_pairs, geometry_of, remark_on_pairs
from sot.robots.posture import rest_angles
from sot.robots.reading import models_of, read_model
from sot.robots.reading.tree import Tree
from sot.robots.robot_file import FEET, GROUPS, POINTS, SERVO, RobotFile
from sot.robots.standing import stand
from sot.robots.surface import Surface, named_surface
from sot.toml_file import named_file

__all__ = ["FEET", "GROUPS", "HANDS", "MODELS", "POINTS", "Robot", "robot_names", "shipped_robot_names"]

MODELS = Path(__file__).parent / "models"
HANDS = ("left_hand", "right_hand")


def robot_names() -> tuple[str, ...]:
    """Names of the robots that the project has a file for; the models of some are fetched when first asked for."""
    return tuple(sorted(path.stem for path in MODELS.glob("*.toml")))


def shipped_robot_names() -> tuple[str, ...]:
    """Names of the robots whose models come with the project."""
    return tuple(name for name in robot_names() if "package" not in RobotFile(MODELS / f"{name}.toml").content)


@dataclass(frozen=True, eq=False)
class Robot:
    """A humanoid, immutable. Arrays are read-only; joints are the `na` actuated ones in Pinocchio's order.

    Attributes:
        name: name of the robot file.
        label: what a reader should call the robot.
        path: model file, MJCF or URDF.
        model: Pinocchio model, its first joint the free base, whose axes are the world's at rest.
        joints: joint names (na).
        rest: rest configuration (nq,), the soles flat on z = 0.
        lower, upper: joint range (na,) [rad].
        velocity, acceleration, acceleration_hard, effort: symmetric limits (na,) [rad/s, rad/s², rad/s², N m];
            `acceleration` is for references and braking, `acceleration_hard` bounds a control tick.
        damping, friction, armature: viscous [N m s/rad] and Coulomb [N m] losses and reflected rotor inertia
            [kg m²] (na,); the armature is part of the model's mass matrix too, the losses of nothing.
        servo: gains of joint servos that the robot file gives, "stiffness" and "damping" (na,) [N m/rad,
            N m s/rad], nan where it gives none.
        shapes: collision shapes, fixed to the model's joints: the model file's, primitives and hulls in the place of
            meshes; its collision pairs are the ones that count, in physics as well as in control and plans.
        rest_distances: of these pairs at rest (pairs,) [m].
        points: operational point -> Pinocchio frame. `<side>_foot` lies on the sole, parallel to the world at rest.
        soles: foot -> contact vertices (nc, 3) in the foot frame [m].
        surfaces: name -> what it may touch the world and things with: the soles, named as their feet, and palms.
        groups: joint group -> indices into the joints; one may be empty.
        tree: the links as numbers, of which both libraries' models are made.
        remarks: what was guessed, mended, left out or is not modelled, a sentence each.
    """

    name: str
    label: str
    path: Path
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
    servo: Mapping[str, np.ndarray] = field(repr=False)
    shapes: pin.GeometryModel = field(repr=False)
    rest_distances: np.ndarray = field(repr=False)
    points: Mapping[str, int] = field(repr=False)
    soles: Mapping[str, np.ndarray] = field(repr=False)
    surfaces: Mapping[str, Surface] = field(repr=False)
    groups: Mapping[str, tuple[int, ...]] = field(repr=False)
    tree: Tree = field(repr=False)
    remarks: tuple[str, ...] = field(repr=False)

    feet = FEET
    hands = HANDS

    @staticmethod
    def load(robot: str | Path) -> "Robot":
        """The robot of a name that `robot_names()` lists, or of a robot file (`.toml`).

        Raises:
            InputError: no such robot, or its file is incomplete or does not fit its model.
        """
        return _load(named_file(robot, MODELS, robot_names(), "robot"))

    def mujoco_spec(self) -> mujoco.MjSpec:
        """The robot alone for MuJoCo, a new one each time: joints in Pinocchio's order, points as sites, no motors."""
        return self.tree.spec()

    @cached_property
    def nq(self) -> int:
        return self.model.nq

    @cached_property
    def nv(self) -> int:
        return self.model.nv

    @cached_property
    def na(self) -> int:
        return self.model.nv - 6

    @cached_property
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

    def surface(self, name: str) -> Surface:
        """A surface of the robot: a sole, by the name of its foot, or another that the robot file names.

        Raises:
            InputError: the robot has no such surface.
        """
        return named_surface(self.surfaces, name, f"{self.name} has")

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
    file = RobotFile(path)
    model_path = file.model_path()
    reading = read_model(model_path, file.locked())
    remarks = list(reading.remarks)
    tree = with_limits(reading.tree, file)
    names = tuple(hinge.name for hinge in tree.hinges)
    limits = joint_limits(tree, file, remarks)
    groups = file.groups(names)
    remark_on_groups(names, limits, groups, remarks)
    rotation, angles = rest_angles(file, reading.key_frames, names, limits["lower"], limits["upper"])
    standing = stand(file, tree, reading.model, rotation, angles, remarks)
    _, model = models_of(standing.tree, model_path, angles)
    rest = np.concatenate([standing.base, [0.0, 0.0, 0.0, 1.0], angles])
    shapes = geometry_of(standing.tree, model)
    pairs, distances = collision_pairs(standing.tree, model, shapes, rest, groups)
    for pair in pairs:
        shapes.addCollisionPair(pin.CollisionPair(*pair))
    named = tuple((shapes.geometryObjects[a].name, shapes.geometryObjects[b].name) for a, b in pairs)
    remark_on_pairs(shapes, groups, remarks)
    points = {name: model.getFrameId(name, pin.FrameType.OP_FRAME) for name in file.points()}
    groups["legs"] = tuple(sorted(groups["left_leg"] + groups["right_leg"]))
    groups["arms"] = tuple(sorted(groups["left_arm"] + groups["right_arm"]))
    surfaces = {foot: Surface.of_sole(foot, corners) for foot, corners in standing.soles.items()} | file.surfaces()
    dofs = slice(6, None)
    losses = {"damping": model.damping[dofs], "friction": model.upperDryFrictionLimit[dofs]}
    return Robot(
        name=path.stem,
        label=file.get("label", str),
        path=model_path,
        model=model,
        joints=names,
        rest=read_only(rest),
        servo=MappingProxyType({gain: read_only(_by_joint(names, file.servo(gain, names))) for gain in SERVO}),
        shapes=shapes,
        rest_distances=read_only(distances),
        points=MappingProxyType(points),
        soles=MappingProxyType({foot: read_only(corners) for foot, corners in standing.soles.items()}),
        surfaces=MappingProxyType(surfaces),
        groups=MappingProxyType(groups),
        tree=replace(standing.tree, pairs=named),
        remarks=tuple(remarks),
        **{name: read_only(values) for name, values in {**limits, **losses, "armature": model.armature[dofs]}.items()},
    )


def _by_joint(joints: Sequence[str], given: Mapping[str, float]) -> np.ndarray:
    return np.array([given.get(joint, np.nan) for joint in joints])
