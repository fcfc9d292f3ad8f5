"""A robot's visible shapes over time, in a recording."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin
import rerun as rr
from scipy.spatial.transform import Rotation

from sim.recording.columns import Color, Columns
from sim.recording.shapes import Shape
from sot.robots.robot import Robot


def send_robot(
    columns: Columns,
    entity: str,
    robot: Robot,
    shapes: list[Shape],
    times: np.ndarray,
    q: np.ndarray,
    ghost_color: Color | None = None,
) -> None:
    """Send a robot's shapes, which go where its bodies are at configurations q (T, nq); a ghost has one colour.

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
        columns.static(entity, _shape_archetype(alike, ghost_color))
        moving.append(_pose_columns(alike, centers.swapaxes(0, 1), (rotations[on] @ turns).swapaxes(0, 1)))
    columns.over_time(entity, times, *moving)


def send_shapes(
    columns: Columns, entity: str, shapes: list[Shape], times: np.ndarray, centers: np.ndarray, rotations: np.ndarray
) -> None:
    """Send n shapes that move: centers (T, n, 3) and rotations (T, n, 3, 3) in the world."""
    for kind in sorted({shape.kind for shape in shapes}):
        on = [k for k, shape in enumerate(shapes) if shape.kind == kind]
        alike = [shapes[k] for k in on]
        columns.static(f"{entity}/{kind}", _shape_archetype(alike, None))
        columns.over_time(f"{entity}/{kind}", times, _pose_columns(alike, centers[:, on], rotations[:, on]))


def send_scenery(columns: Columns, entity: str, shapes: list[Shape]) -> None:
    """Send shapes that stay where they are."""
    for kind in sorted({shape.kind for shape in shapes}):
        alike = [shape for shape in shapes if shape.kind == kind]
        rotations = Rotation.from_quat([shape.quaternion for shape in alike]).as_matrix()[None]
        places = np.array([shape.position for shape in alike])[None]
        columns.static(f"{entity}/{kind}", _shape_archetype(alike, None))
        columns.over_time(f"{entity}/{kind}", np.zeros(1), _pose_columns(alike, places, rotations))


def _shape_archetype(alike: list[Shape], ghost_color: Color | None) -> rr.AsComponents:
    """Sizes and colours of shapes of one kind."""
    sizes = np.array([shape.half_sizes for shape in alike])
    look: dict[str, Any] = {"colors": [ghost_color or shape.color for shape in alike], "fill_mode": "solid"}
    match alike[0].kind:
        case "box":
            return rr.Boxes3D.from_fields(half_sizes=sizes, **look)
        case "ellipsoid":
            return rr.Ellipsoids3D.from_fields(half_sizes=sizes, **look)
        case "cylinder":
            return rr.Cylinders3D.from_fields(lengths=2 * sizes[:, 2], radii=sizes[:, 0], **look)
        case _:
            return rr.Capsules3D.from_fields(lengths=2 * sizes[:, 2], radii=sizes[:, 0], **look)


def _pose_columns(alike: list[Shape], centers: np.ndarray, rotations: np.ndarray) -> rr.ComponentColumnList:
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


def body_poses(robot: Robot, bodies: Sequence[str], q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """World positions (B, T, 3) [m] and rotations (B, T, 3, 3) of bodies at configurations (T, nq)."""
    return _frame_poses(robot, [robot.model.getFrameId(body, pin.FrameType.BODY) for body in bodies], q)


def point_poses(robot: Robot, points: Sequence[str], q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """World positions (P, T, 3) [m] and rotations (P, T, 3, 3) of operational points at configurations (T, nq)."""
    return _frame_poses(robot, [robot.point(point) for point in points], q)


def _frame_poses(robot: Robot, frames: Sequence[int], q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    data = robot.model.createData()
    positions = np.empty((len(frames), len(q), 3))
    rotations = np.empty((len(frames), len(q), 3, 3))
    for row, configuration in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, configuration)
        for index, frame in enumerate(frames):
            placement = data.oMf[frame]
            positions[index, row] = placement.translation
            rotations[index, row] = placement.rotation
    return positions, rotations
