"""The MuJoCo model of a robot on a floor with things around it, built from the model files of all of them."""

from collections.abc import Sequence

import mujoco
import numpy as np
import pinocchio as pin

from sim.hardware.assembly import add_hardware, robot_spec
from sim.own_scene import ALL_COLLISION_BITS, Scene, add_scene
from sim.sensors import FloorSensors
from sot.control.load import Carried
from sot.errors import InputError
from sot.hardware.hardware import TORQUE_DRIVEN, Hardware
from sot.robots.reading.pinocchio_model import placement
from sot.robots.reading.solid import VISUAL_GROUP
from sot.robots.robot import Robot
from sot.robots.surface import Surface
from sot.robots.things.thing import Thing

IMPRATIO = 10.0  # friction is that much stiffer than the normal force
# Contacts take velocity out at the rate 2 / (0.95 time constant), but MuJoCo leaves J̇ v out of their equations, the
# acceleration that the other joints' motion gives a sole: a standing foot creeps at J̇ v over that rate. Being mostly
# centripetal, it does not average out, and feet walk off under a body that twists; on the default floor, soft with its
# 20 ms, by centimetres a minute.
FLOOR_SOLREF = (0.005, 1.0)  # time constant [s] and damping ratio
PAD_FRICTION = 1.0  # of the rubber pads in front of palms
GRAIN_INERTIA = 1e-6  # kg m² a kg: of a ball of 1.6 mm
PAD_COLOR = (0.15, 0.15, 0.16, 1.0)
# Of two geoms MuJoCo takes the larger friction, unless one has priority: then its own.
SURROUNDINGS_PRIORITY, PAD_PRIORITY = 1, 2


def build_model(
    robot: Robot,
    timestep: float = 0.001,
    friction: float = 0.7,
    scene: Scene | None = None,
    things: Sequence[Thing] = (),
    loads: Sequence[Carried] = (),
    hardware: Hardware = TORQUE_DRIVEN,
) -> mujoco.MjModel:
    """The robot, driven by one torque motor or servo a joint (Pinocchio's order), on a plane at z = 0.

    Args:
        robot: the robot, as its tree has it.
        timestep: of the physics [s].
        friction: coefficient of every contact with the floor.
        scene: what else is in the world.
        things: what the robot may handle, stand on and lean on.
        loads: masses that are fixed to the robot.
        hardware: what is between commands and joints, ankles and soles, robot and readings.

    Raises:
        InputError: MuJoCo cannot compile it.
    """
    try:
        spec = robot_spec(robot, hardware, timestep)
        _add_motors(spec, robot)
        add_hardware(spec, robot, hardware)
        _add_floor(spec, friction)
        _add_lights(spec)
        _add_pads(spec, robot)
        for load in loads:
            _add_load(spec, robot, load)
        for thing in things:
            _add_thing(spec, thing)
        _add_sensors(spec, robot)
        if scene is not None:
            add_scene(spec, scene)
        _set_options(spec, robot, timestep)
        return spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        whole = "it and the scene" if scene is not None else "it and the things" if things else "it"
        raise InputError(f"{robot.path}: MuJoCo cannot compile {whole}: {' '.join(str(error).split())}") from None


def _add_motors(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Ideal torque motors with the robot's effort limits."""
    for name, effort in zip(robot.joints, robot.effort, strict=True):
        spec.joint(name).actfrcrange = [-effort, effort]
        motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_motor()
        motor.ctrlrange = [-effort, effort]
        motor.ctrllimited = True


def _add_sensors(spec: mujoco.MjSpec, robot: Robot) -> None:
    sites = {foot: spec.site(foot) for foot in robot.feet}
    FloorSensors.add_to(spec, {foot: (site.parent, site.pos) for foot, site in sites.items()})


def _add_pads(spec: mujoco.MjSpec, robot: Robot) -> None:
    """A rubber pad behind each surface of the robot that is no sole; it weighs nothing, and meets no part of the robot.

    The robot's own shapes meet in the pairs of one list only, in which pads are not.
    """
    for name, surface in robot.surfaces.items():
        if name not in robot.feet:
            site = spec.site(surface.point)
            _add_pad(spec, site.parent, placement(site.pos, site.quat), surface)


def _add_pad(spec: mujoco.MjSpec, body: mujoco.MjsBody, point: pin.SE3, surface: Surface) -> None:
    half, place = surface.pad()
    at = point * place
    x, y, z, w = pin.Quaternion(at.rotation).coeffs()
    body.add_geom(
        name=surface.name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=half,
        pos=at.translation,
        quat=[w, x, y, z],
        mass=0.0,
        friction=[PAD_FRICTION, 0.005, 0.0001],
        priority=PAD_PRIORITY,
        solref=FLOOR_SOLREF,
        conaffinity=0,
        group=VISUAL_GROUP,
        rgba=PAD_COLOR,
    )


def _add_load(spec: mujoco.MjSpec, robot: Robot, load: Carried) -> None:
    """Fix a mass to the robot's body that carries a point."""
    robot.point(load.point)
    site, inertia = spec.site(load.point), load.inertia
    body = site.parent.add_body(name=load.name, pos=site.pos, quat=site.quat)
    body.explicitinertial, body.mass, body.ipos = True, inertia.mass, inertia.lever
    # MuJoCo's bodies without any inertia are refused where they move: a load that is a point gets a grain's.
    turning = inertia.inertia + GRAIN_INERTIA * inertia.mass * np.eye(3)
    body.fullinertia = [*np.diagonal(turning), turning[0, 1], turning[0, 2], turning[1, 2]]


def _add_thing(spec: mujoco.MjSpec, thing: Thing) -> None:
    """Add a thing; what may collide at all of it may collide with anything but itself."""
    before = list(spec.geoms)
    thing.add_to(spec)
    # A second robot's shapes meet one another in its own pairs only.
    bits = (2, 1) if thing.compiled.npair else (1, ALL_COLLISION_BITS)
    for geom in spec.geoms:
        if (geom.contype or geom.conaffinity) and not any(geom is other for other in before):
            geom.contype, geom.conaffinity = bits
            geom.solref, geom.priority, geom.condim = FLOOR_SOLREF, SURROUNDINGS_PRIORITY, 3


def _add_floor(spec: mujoco.MjSpec, friction: float) -> None:
    spec.add_texture(
        name="floor",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.80, 0.82, 0.85],
        rgb2=[0.70, 0.72, 0.76],
        width=256,
        height=256,
    )
    material = spec.add_material(name="floor", texrepeat=[1, 1], texuniform=True)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "floor"
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 0.5],
        material="floor",
        friction=[friction, 0.005, 0.0001],
        priority=SURROUNDINGS_PRIORITY,
        condim=3,
        solref=FLOOR_SOLREF,
        conaffinity=ALL_COLLISION_BITS,
    )


def _add_lights(spec: mujoco.MjSpec) -> None:
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    for position in ([2.0, -2.0, 4.0], [1.0, 3.0, 4.0]):
        direction = -np.array(position) / np.linalg.norm(position)
        spec.worldbody.add_light(pos=position, dir=direction, diffuse=[0.4, 0.4, 0.4])


def _set_options(spec: mujoco.MjSpec, robot: Robot, timestep: float) -> None:
    spec.option.timestep = timestep
    spec.option.gravity = robot.model.gravity.linear
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = IMPRATIO
    # A diverged simulation must show, not start again from the reference posture.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
