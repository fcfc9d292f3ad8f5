"""The robot's visible shapes, as its model has them."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from sim.own_scene import Scene
from sim.scene import build_model
from sot.robots.robot import Robot
from sot.robots.things.thing import Thing

SHAPE_KINDS = {
    mujoco.mjtGeom.mjGEOM_BOX: "box",
    mujoco.mjtGeom.mjGEOM_SPHERE: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
}
FIRST_HIDDEN_GROUP = 3  # MuJoCo's viewers show geom groups 0 to 2: a model keeps its collision shapes in the others


@dataclass(frozen=True)
class Shape:
    """A primitive on a body.

    Attributes:
        body: name of the body.
        kind: box, ellipsoid, capsule or cylinder; the latter two lie along their own z axis.
        half_sizes: half extents of a box, semi-axes of an ellipsoid, else (radius, radius, half length without the
            caps) [m].
        position: centre in the body frame [m].
        quaternion: orientation in the body frame, xyzw.
        color: rgba, 0..255.
        geom: its number in the model that it was read from.
    """

    body: str
    kind: str
    half_sizes: np.ndarray
    position: np.ndarray
    quaternion: np.ndarray
    color: tuple[int, int, int, int]
    geom: int = -1


def read_shapes(robot: Robot) -> list[Shape]:
    """Visible shapes of a robot's model."""
    model = robot.mujoco_spec().compile()
    return [
        _shape(model, geom)
        for geom in range(model.ngeom)
        if model.geom_bodyid[geom] > 0 and model.geom_group[geom] < FIRST_HIDDEN_GROUP
    ]


def thing_shapes(thing: Thing) -> list[Shape]:
    """Visible shapes of a thing."""
    model = thing.compiled
    return [_shape(model, geom) for geom in range(model.ngeom) if model.geom_group[geom] < FIRST_HIDDEN_GROUP]


def read_scenery(robot: Robot, scene: Scene) -> list[Shape]:
    """Visible shapes of a scene that do not move, placed in the world; the floor is not among them."""
    model = build_model(robot, scene=scene)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    shapes = []
    for geom in range(model.ngeom):
        still = model.body_weldid[model.geom_bodyid[geom]] == 0 and model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE
        if still and model.geom_group[geom] < FIRST_HIDDEN_GROUP:
            quaternion = np.empty(4)
            mujoco.mju_mat2Quat(quaternion, data.geom_xmat[geom])
            w, x, y, z = quaternion
            placed = {"position": data.geom_xpos[geom].copy(), "quaternion": np.array([x, y, z, w])}
            shapes.append(replace(_shape(model, geom), **placed))
    return shapes


def _shape(model: mujoco.MjModel, geom: int) -> Shape:
    size, position = model.geom_size[geom].copy(), model.geom_pos[geom].copy()
    w, x, y, z = model.geom_quat[geom]
    kind = SHAPE_KINDS[mujoco.mjtGeom(model.geom_type[geom])]
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_SPHERE:
        size[:] = size[0]
    elif kind in ("capsule", "cylinder"):
        size = np.array([size[0], size[0], size[1]])
    red, green, blue, alpha = (round(255 * float(channel)) for channel in model.geom_rgba[geom])
    body = str(model.body(model.geom_bodyid[geom]).name)
    return Shape(body, kind, size, position, np.array([x, y, z, w]), (red, green, blue, alpha), geom)
