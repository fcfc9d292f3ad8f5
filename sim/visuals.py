"""What a recording shows in 3D: the robot between the human and its reference, forces, support, CoM and ZMP."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin
import rerun as rr
from scipy.spatial.transform import Rotation

from sim.columns import COLORS, Color, Columns
from sim.log import RunInfo, RunLog, nearest_frames
from sim.push import Push
from sim.shapes import Shape, read_shapes
from sim.support import planned_support
from sot.motion.human import SEGMENTS, SIDES, Human
from sot.motion.trajectory import Motion
from sot.robot import Robot

FRAME_RATE = 60.0  # Hz; curves keep the control rate
BESIDE = 1.2  # m from the robot to the human on one side and to its reference on the other
METRES_PER_NEWTON = 1e-3  # length of a force arrow
PUSH_METRES_PER_NEWTON = 4e-3  # a push is weaker than a weight
ON_FLOOR = 0.004  # m: what lies on the floor is drawn this much above it
BONES = (
    *(bone for name, bone in SEGMENTS.items() if name != "trunk"),
    *pairwise(("waist", "chest", "neck", "head")),
    *((start, f"{side}_{end}") for side in SIDES for start, end in (("waist", "hip"), ("neck", "shoulder"))),
    *((f"{side}_ankle", f"{side}_toe") for side in SIDES),
)


def send_visuals(columns: Columns, log: RunLog, info: RunInfo, motion: Motion, human: Human | None) -> None:
    """Send all that is seen in 3D, `FRAME_RATE` times a second."""
    rows = log.rows_at(FRAME_RATE)
    times = log.time[rows]
    shapes = read_shapes(motion.robot.path)
    columns.static("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    _send_floor(columns)
    _send_robot(columns, "world/robot", motion.robot, shapes, times, log.q[rows])
    reference = motion.q[nearest_frames(times, motion.rate, len(motion.q))]
    _send_robot(columns, "world/reference", motion.robot, shapes, times, reference, ghost=COLORS["ghost"])
    _send_name(columns, "world/robot", motion.robot.label)
    _send_name(columns, "world/reference", "reference")
    columns.static("world/reference", rr.Transform3D(translation=[0.0, BESIDE, 0.0]))
    if human is not None:
        _send_human(columns, human, times)
        _send_name(columns, "world/human", "human, scaled")
        columns.static("world/human", rr.Transform3D(translation=[0.0, -BESIDE, 0.0]))
    _send_forces(columns, log, motion.robot, rows)
    _send_pushes(columns, log, info.pushes, motion.robot, rows)
    _send_balance(columns, log, motion, rows)


def body_poses(robot: Robot, bodies: list[str], q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """World positions (B, T, 3) [m] and rotations (B, T, 3, 3) of bodies at configurations (T, nq)."""
    data = robot.model.createData()
    frames = [robot.model.getFrameId(body, pin.FrameType.BODY) for body in bodies]
    positions = np.empty((len(bodies), len(q), 3))
    rotations = np.empty((len(bodies), len(q), 3, 3))
    for row, configuration in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, configuration)
        for body, frame in enumerate(frames):
            placement = data.oMf[frame]
            positions[body, row] = placement.translation
            rotations[body, row] = placement.rotation
    return positions, rotations


def _send_floor(columns: Columns) -> None:
    half = np.array([2.0, 3.0, 0.01])
    slab = rr.Boxes3D(half_sizes=[half], centers=[[0.0, 0.0, -0.012]], colors=[COLORS["floor"]], fill_mode="solid")
    columns.static("world/floor", slab)
    across = [[[x, -half[1], 0.0], [x, half[1], 0.0]] for x in np.arange(-half[0], half[0] + 0.1, 0.5)]
    along = [[[-half[0], y, 0.0], [half[0], y, 0.0]] for y in np.arange(-half[1], half[1] + 0.1, 0.5)]
    columns.static("world/floor/grid", rr.LineStrips3D(across + along, colors=[COLORS["grid"]], radii=[0.002]))


def _send_robot(
    columns: Columns,
    entity: str,
    robot: Robot,
    shapes: list[Shape],
    times: np.ndarray,
    q: np.ndarray,
    ghost: Color | None = None,
) -> None:
    """A robot's shapes where its bodies are; a ghost has one colour.

    All shapes are instances of one entity: a viewer takes longer over an entity than over what is in it.
    """
    bodies = sorted({shape.body for shape in shapes})
    positions, rotations = body_poses(robot, bodies, q)
    moving = []
    for kind in sorted({shape.kind for shape in shapes}):
        alike = [shape for shape in shapes if shape.kind == kind]
        on = [bodies.index(shape.body) for shape in alike]
        places = np.array([shape.position for shape in alike])[:, None, :, None]
        turns = Rotation.from_quat([shape.quaternion for shape in alike]).as_matrix()[:, None]
        centers = positions[on] + (rotations[on] @ places)[..., 0]
        columns.static(entity, _look(alike, ghost))
        moving.append(_placed(alike, centers.swapaxes(0, 1), (rotations[on] @ turns).swapaxes(0, 1)))
    columns.over_time(entity, times, *moving)


def _look(alike: list[Shape], ghost: Color | None) -> rr.AsComponents:
    """Sizes and colours of shapes of one kind."""
    sizes = np.array([shape.half_sizes for shape in alike])
    look: dict[str, Any] = {"colors": [ghost or shape.color for shape in alike], "fill_mode": "solid"}
    match alike[0].kind:
        case "box":
            return rr.Boxes3D.from_fields(half_sizes=sizes, **look)
        case "ellipsoid":
            return rr.Ellipsoids3D.from_fields(half_sizes=sizes, **look)
        case "cylinder":
            return rr.Cylinders3D.from_fields(lengths=2 * sizes[:, 2], radii=sizes[:, 0], **look)
        case _:
            return rr.Capsules3D.from_fields(lengths=2 * sizes[:, 2], radii=sizes[:, 0], **look)


def _placed(alike: list[Shape], centers: np.ndarray, rotations: np.ndarray) -> rr.ComponentColumnList:
    """Columns of the poses of n shapes of one kind over time: centers (T, n, 3), rotations (T, n, 3, 3)."""
    count, size = centers.shape[:2]
    quaternions = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat().astype(np.float32)
    match alike[0].kind:
        case "box":
            pose = rr.Boxes3D.columns(centers=centers.reshape(-1, 3), quaternions=quaternions)
        case "ellipsoid":
            pose = rr.Ellipsoids3D.columns(centers=centers.reshape(-1, 3), quaternions=quaternions)
        case "cylinder":
            pose = rr.Cylinders3D.columns(centers=centers.reshape(-1, 3), quaternions=quaternions)
        case _:  # rerun's capsule starts at one end
            half = np.array([shape.half_sizes[2] for shape in alike])
            ends = centers - half[:, None] * rotations[..., 2]
            pose = rr.Capsules3D.columns(translations=ends.reshape(-1, 3), quaternions=quaternions)
    return pose.partition([size] * count)


def _send_human(columns: Columns, human: Human, times: np.ndarray) -> None:
    frames = nearest_frames(times, human.rate, human.count)
    ends = [np.stack([human.points[near][frames], human.points[far][frames]], axis=1) for near, far in BONES]
    strips = np.stack(ends, axis=1).reshape(-1, 2, 3).astype(np.float32)
    columns.static("world/human/bones", rr.LineStrips3D.from_fields(colors=[COLORS["human"]], radii=[0.018]))
    columns.over_time(
        "world/human/bones", times, rr.LineStrips3D.columns(strips=strips).partition([len(BONES)] * len(times))
    )


def _send_name(columns: Columns, entity: str, name: str) -> None:
    place = [[0.0, 0.0, 1.75]]
    label = rr.Points3D(place, labels=[name], radii=[0.001], colors=[COLORS["text"]], show_labels=True)
    columns.static(f"{entity}/name", label)


def _send_forces(columns: Columns, log: RunLog, robot: Robot, rows: np.ndarray) -> None:
    """The floor's force on each foot: an arrow from below whose tip is the centre of pressure, out of the leg's way."""
    data = robot.model.createData()
    origins = np.empty((len(robot.feet), len(rows), 3))
    for index, q in enumerate(log.q[rows]):
        pin.forwardKinematics(robot.model, data, q)
        for foot, name in enumerate(robot.feet):
            origins[foot, index] = pin.updateFramePlacement(robot.model, data, robot.point(name)).translation
    for foot, name in enumerate(robot.feet):
        wrench = log.foot_wrench[rows, foot]
        loaded = wrench[:, 2] > 1.0
        force, moment = wrench[loaded, :3], wrench[loaded, 3:]
        origin = origins[foot, loaded]
        origin[:, 0] -= moment[:, 1] / force[:, 2]
        origin[:, 1] += moment[:, 0] / force[:, 2]
        entity = f"world/contact/{name}"
        columns.static(entity, rr.Arrows3D.from_fields(colors=[COLORS["measured"]], radii=[0.008]))
        arrow = METRES_PER_NEWTON * force
        arrows = rr.Arrows3D.columns(vectors=arrow, origins=origin - arrow)
        columns.over_time(entity, log.time[rows], arrows.partition(loaded.astype(int)))


def _send_pushes(columns: Columns, log: RunLog, pushes: Sequence[Push], robot: Robot, rows: np.ndarray) -> None:
    """An arrow onto the body that is pushed, for as long as it is."""
    data = robot.model.createData()
    for index, push in enumerate(pushes):
        acting = rows[[push.acts(t) for t in log.time[rows]]]
        if not len(acting):
            continue
        tips = np.empty((len(acting), 3))
        for tip, q in zip(tips, log.q[acting], strict=True):
            pin.forwardKinematics(robot.model, data, q)
            tip[:] = pin.updateFramePlacement(robot.model, data, robot.point(push.body)).translation
        entity, arrow = f"world/push/{index}", PUSH_METRES_PER_NEWTON * np.array(push.force)
        columns.static(entity, rr.Arrows3D.from_fields(colors=[COLORS["limit"]], radii=[0.015]))
        shown = rr.Arrows3D.columns(vectors=np.tile(arrow, (len(tips), 1)), origins=tips - arrow)
        # What is logged last stays: an empty row takes the arrow away.
        columns.over_time(entity, log.time[acting], shown.partition([1] * len(tips)))
        columns.over_time(entity, np.array([push.end]), rr.Arrows3D.columns(vectors=np.empty((0, 3))).partition([0]))


def _send_balance(columns: Columns, log: RunLog, motion: Motion, rows: np.ndarray) -> None:
    times = log.time[rows]
    columns.points("world/balance/com", times, log.com[rows], "com", 0.03)
    on_floor = np.full((len(rows), 1), ON_FLOOR)
    zmps = {"measured": log.zmp_measured, "controller": log.zmp_control, "planned": log.zmp_planned}
    for name, zmp in zmps.items():
        columns.points(f"world/balance/zmp_{name}", times, np.hstack([zmp[rows], on_floor]), name, 0.012)
    outlines: dict[int, np.ndarray] = {}
    for shared, polygon in planned_support(log, motion):
        closed = np.vstack([polygon.vertices, polygon.vertices[:1]])
        outline = np.column_stack([closed, np.full(len(closed), ON_FLOOR)]).astype(np.float32)
        outlines.update(dict.fromkeys(np.intersect1d(shared, rows).tolist(), outline))
    columns.static("world/contact/support", rr.LineStrips3D.from_fields(colors=[COLORS["planned"]], radii=[0.005]))
    shown = [outlines[row] for row in rows.tolist() if row in outlines]
    lengths = [int(row in outlines) for row in rows.tolist()]
    columns.over_time("world/contact/support", times, rr.LineStrips3D.columns(strips=shown).partition(lengths))
