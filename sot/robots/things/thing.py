"""A thing: a body that is no robot, free, on passive or actuated joints, or fixed in the world; with its surfaces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType

import mujoco
import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.read_only import read_only
from sot.robots.reading.mjcf import BALL, FREE, joint_efforts, shape_of_geom
from sot.robots.reading.pinocchio_model import pinocchio_model
from sot.robots.reading.solid import Solid
from sot.robots.robot import Robot
from sot.robots.surface import Surface, named_surface
from sot.robots.things.thing_file import ThingFile
from sot.toml_file import named_file

__all__ = ["MODELS", "Thing", "thing_names"]

Array = np.ndarray
MODELS = Path(__file__).parent / "models"


def thing_names() -> tuple[str, ...]:
    """Names of the things that come with the project."""
    return tuple(sorted(path.stem for path in MODELS.glob("*.toml")))


@dataclass(frozen=True, eq=False)
class Thing:
    """A body that is no robot, immutable. Arrays are read-only, one entry a velocity (nv,) unless said otherwise.

    Attributes:
        name: what it is called in a world; names of its bodies, joints, points and surfaces are "name/...".
        label: what a reader should call it.
        model: Pinocchio model, its first joints fixed to the world; no joints if the thing does not move.
        rest: configuration as it is placed (nq,).
        stiffness, spring_reference: of springs in its joints [N m/rad], and where they are relaxed [rad].
        damping, friction: viscous [N m s/rad] and Coulomb [N m] losses of its joints.
        effort: limits of its motors [N m]; 0 where it has none.
        points: operational point -> Pinocchio frame; `name` itself is the thing's main body.
        surfaces: name without the thing's -> surface.
        solids: what it collides with: Pinocchio frame of the body, and shape.
        compiled: MuJoCo's model of the thing alone.
    """

    name: str
    label: str
    model: pin.Model = field(repr=False)
    rest: Array = field(repr=False)
    stiffness: Array = field(repr=False)
    spring_reference: Array = field(repr=False)
    damping: Array = field(repr=False)
    friction: Array = field(repr=False)
    effort: Array = field(repr=False)
    points: Mapping[str, int] = field(repr=False)
    surfaces: Mapping[str, Surface] = field(repr=False)
    solids: tuple[tuple[int, Solid], ...] = field(repr=False)
    compiled: mujoco.MjModel = field(repr=False)
    _source: mujoco.MjSpec = field(repr=False)
    _placement: pin.SE3 = field(repr=False)

    @staticmethod
    def load(
        thing: str | Path,
        name: str | None = None,
        placement: pin.SE3 | Sequence[float] = (0.0, 0.0, 0.0),
        mass: float | None = None,
        size: Sequence[float] | None = None,
        friction: float | None = None,
        stiffness: float | None = None,
        damping: float | None = None,
    ) -> "Thing":
        """The thing of a name that `thing_names()` lists, or of a thing file (`.toml`).

        Args:
            thing: name or file.
            name: what it is to be called; the file's name unless given.
            placement: of its model in the world at rest, or its position (3,) [m].
            mass: total mass [kg] in the place of the model's.
            size: full sides (3,) [m] in the place of the file's.
            friction: of its shapes in physics, in the place of the model's.
            stiffness, damping: of its joints [N m/rad, N m s/rad], in the place of the model's.

        Raises:
            InputError: no such thing, its file or model cannot be read, a body of it moves without mass, or a value
                makes no sense.
        """
        path = named_file(thing, MODELS, thing_names(), "thing")
        file, name = ThingFile(path, size), name or path.stem
        made = _of_spec(
            file.spec(mass, friction, stiffness, damping), name, file.label, _as_placement(placement), file.body
        )
        points = [point.removeprefix(f"{name}/") for point in made.points]
        return _with_surfaces(made, file.surfaces(points, name))

    @staticmethod
    def of_robot(robot: Robot, name: str, placement: pin.SE3 | Sequence[float] = (0.0, 0.0, 0.0)) -> "Thing":
        """A second robot as an actuated thing in the world of a first one: what Otani's "multi-robot" means.

        Args:
            robot: a robot; its points and surfaces are "name/...".
            name: what it is to be called.
            placement: of its rest posture in the world, or its position (3,) [m].
        """
        spec = robot.mujoco_spec()
        for joint, effort in zip(robot.joints, robot.effort, strict=True):
            motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            motor.set_to_motor()
            motor.ctrllimited, motor.ctrlrange = True, [-effort, effort]
        made = _of_spec(spec, name, robot.label, pin.SE3.Identity())
        base = _as_placement(placement) * pin.XYZQUATToSE3(robot.rest[:7])
        rest = np.concatenate([pin.SE3ToXYZQUAT(base), robot.rest[7:]])
        return _with_surfaces(replace(made, rest=read_only(rest)), robot.surfaces)

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add the thing to a MuJoCo specification, in its place and with its names."""
        _attach(spec, self._source.copy(), self.name, self._placement)

    @property
    def nq(self) -> int:
        return self.model.nq

    @property
    def nv(self) -> int:
        return self.model.nv

    @property
    def mass(self) -> float:
        """Mass of what of it moves [kg]."""
        return float(sum(inertia.mass for inertia in self.model.inertias[1:]))

    @property
    def is_free(self) -> bool:
        """Whether its first joint is a free one, so that it can be carried."""
        return self.model.njoints > 1 and self.model.joints[1].nq == 7

    def surface(self, name: str) -> Surface:
        """A surface of the thing.

        Raises:
            InputError: the thing has no such surface.
        """
        return named_surface(self.surfaces, name, f"{self.name} has")


def _as_placement(placement: pin.SE3 | Sequence[float]) -> pin.SE3:
    if isinstance(placement, pin.SE3):
        return placement
    position = np.array(placement, dtype=float)
    if position.shape != (3,) or not np.isfinite(position).all():
        raise InputError(f"a thing's placement is a pinocchio.SE3 or three numbers [m], not {placement}")
    return pin.SE3(np.eye(3), position)


def _attach(spec: mujoco.MjSpec, added: mujoco.MjSpec, name: str, placement: pin.SE3) -> None:
    x, y, z, w = pin.Quaternion(placement.rotation).coeffs()
    frame = spec.worldbody.add_frame(pos=placement.translation, quat=[w, x, y, z])
    spec.attach(added, frame=frame, prefix=f"{name}/")


def _of_spec(spec: mujoco.MjSpec, name: str, label: str, placement: pin.SE3, body: str | None = None) -> Thing:
    """A thing without surfaces from a specification; its main body is the first that moves, or the first, unless given.

    Raises:
        InputError: the model has no such body, or a ball joint.
    """
    alone = mujoco.MjSpec()
    alone.modelname = name
    _attach(alone, spec.copy(), name, placement)
    compiled = alone.compile()
    if np.any(compiled.jnt_type == BALL):
        raise InputError(f"thing '{name}' has a ball joint: joints of things are free, slide, or turn about one axis")
    model = pinocchio_model(compiled)
    moving = [k for k in range(1, compiled.nbody) if compiled.body_weldid[k]]
    frames = {frame.name: k for k, frame in enumerate(model.frames) if frame.type != pin.FrameType.JOINT}
    main = compiled.body((moving or [1])[0]).name if body is None else f"{name}/{body}"
    if main not in frames:
        raise InputError(f"thing '{name}': its model has no body '{body}'")
    points = {name: frames[main]} | {point: k for point, k in frames.items() if point.startswith(f"{name}/")}
    stiffness, reference, effort = np.zeros(model.nv), np.zeros(model.nv), np.zeros(model.nv)
    efforts = joint_efforts(compiled)
    for k in range(compiled.njnt):
        dof = compiled.jnt_dofadr[k]
        if compiled.jnt_type[k] != FREE:
            stiffness[dof] = np.ravel(compiled.jnt_stiffness[k])[0]
            reference[dof] = compiled.qpos_spring[compiled.jnt_qposadr[k]]
        if k in compiled.actuator_trnid[:, 0]:
            effort[dof] = efforts[k]
    q = compiled.qpos0.copy()
    for k in range(compiled.njnt):
        if compiled.jnt_type[k] == FREE:
            at = compiled.jnt_qposadr[k] + 3
            q[at : at + 4] = q[[at + 1, at + 2, at + 3, at]]  # to Pinocchio's order xyzw
    solids = []
    for geom in range(compiled.ngeom):
        shape = shape_of_geom(compiled, geom)
        if isinstance(shape, Solid) and (shape.contype or shape.conaffinity):
            solids.append((frames.get(compiled.body(compiled.geom_bodyid[geom]).name, 0), shape))
    return Thing(
        name=name,
        label=label,
        model=model,
        rest=read_only(q),
        stiffness=read_only(stiffness),
        spring_reference=read_only(reference),
        damping=read_only(model.damping),
        friction=read_only(model.upperDryFrictionLimit),
        effort=read_only(effort),
        points=MappingProxyType(points),
        surfaces=MappingProxyType({}),
        solids=tuple(solids),
        compiled=compiled,
        _source=spec,
        _placement=placement,
    )


def _with_surfaces(thing: Thing, surfaces: Mapping[str, Surface]) -> Thing:
    """The thing with surfaces whose points are named without its name; those of what does not move are the world's."""
    named = {}
    for key, surface in surfaces.items():
        point = thing.name if surface.point == thing.name else f"{thing.name}/{surface.point}"
        frame, placement = thing.model.frames[thing.points[point]], surface.placement
        fixed = frame.parentJoint == 0
        named[key] = replace(
            surface,
            name=f"{thing.name}/{key}",
            point=None if fixed else point,
            placement=frame.placement * placement if fixed else placement,
        )
    return replace(thing, surfaces=MappingProxyType(named))
