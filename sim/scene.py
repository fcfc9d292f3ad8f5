"""The MuJoCo model of a robot on a floor, built from the robot's own model file."""

import mujoco
import numpy as np

from sim.own_scene import ALL_COLLISION_BITS, Scene, add_scene
from sim.sensors import FloorSensors
from sot.errors import InputError
from sot.robots.robot import Robot

IMPRATIO = 10.0  # friction is that much stiffer than the normal force
# Contacts take velocity out at the rate 2 / (0.95 time constant), but MuJoCo leaves J̇ v out of their equations, the
# acceleration that the other joints' motion gives a sole: a standing foot creeps at J̇ v over that rate. Being mostly
# centripetal, it does not average out, and feet walk off under a body that twists; on the default floor, soft with its
# 20 ms, by centimetres a minute.
FLOOR_SOLREF = (0.005, 1.0)  # time constant [s] and damping ratio


def build_model(
    robot: Robot, timestep: float = 0.001, friction: float = 0.7, scene: Scene | None = None
) -> mujoco.MjModel:
    """The robot, driven by one torque motor a joint (Pinocchio's order), on a plane at z = 0.

    Args:
        robot: the robot, as its tree has it.
        timestep: of the physics [s].
        friction: coefficient of every contact with the floor.
        scene: what else is in the world.

    Raises:
        InputError: MuJoCo cannot compile it.
    """
    try:
        spec = robot.mujoco_spec()
        _add_motors(spec, robot)
        _add_floor(spec, friction)
        _add_lights(spec)
        _add_sensors(spec, robot)
        if scene is not None:
            add_scene(spec, scene)
        _set_options(spec, robot, timestep)
        return spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        whole = "it" if scene is None else "it and the scene"
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
        # Of two geoms MuJoCo takes the larger friction, unless one has priority: then its own.
        friction=[friction, 0.005, 0.0001],
        priority=1,
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
