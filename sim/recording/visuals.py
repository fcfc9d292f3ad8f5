"""The 3D view of a recording: the robot between the human and its reference, on a floor."""

from itertools import pairwise

import numpy as np
import rerun as rr

from sim.log import RunInfo, RunLog, nearest_frames
from sim.recording.bodies import send_robot, send_scenery
from sim.recording.columns import COLORS, Columns
from sim.recording.footing import send_footing
from sim.recording.forces import send_forces, send_pushes
from sim.recording.panels import FRAME_RATE
from sim.recording.shapes import Shape, read_shapes
from sot.motion.human.human import SEGMENTS, SIDES, Human
from sot.motion.trajectory import Motion

SIDE_DISTANCE = 1.2  # m from the robot to the human on one side and to its reference on the other
FLOOR_MARGIN = 2.0  # m, of floor on all sides of where the robot goes
TILE_SIZE = 0.5  # m
NAME_HEIGHT = 1.75  # m, of names above the floor
BONES = (
    *(bone for name, bone in SEGMENTS.items() if name != "trunk"),
    *pairwise(("waist", "chest", "neck", "head")),
    *((start, f"{side}_{end}") for side in SIDES for start, end in (("waist", "hip"), ("neck", "shoulder"))),
    *((f"{side}_ankle", f"{side}_toe") for side in SIDES),
)


def send_visuals(
    columns: Columns, log: RunLog, info: RunInfo, motion: Motion, human: Human | None, scenery: list[Shape]
) -> None:
    """Send everything in the 3D view at `FRAME_RATE`."""
    rows = log.rows_at(FRAME_RATE)
    times = log.time[rows]
    shapes = read_shapes(motion.robot)
    columns.static("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    send_floor(columns, motion)
    send_scenery(columns, "world/scene", scenery)
    send_robot(columns, "world/robot", motion.robot, shapes, times, log.q[rows])
    send_name(columns, "world/robot", motion.robot.label, times, log.q[rows, :2])
    send_forces(columns, log, motion.robot, rows)
    send_pushes(columns, log, info.pushes, motion.robot, rows)
    send_footing(columns, log, motion, rows)
    reference = motion.q[nearest_frames(times, motion.rate, len(motion.q))]
    send_robot(columns, "world/reference", motion.robot, shapes, times, reference, ghost_color=COLORS["ghost"])
    send_name(columns, "world/reference", "reference", times, reference[:, :2])
    columns.static("world/reference", rr.Transform3D(translation=[0.0, SIDE_DISTANCE, 0.0]))
    if human is not None:
        send_human(columns, human, times)
        waist = human.points["waist"][nearest_frames(times, human.rate, human.count)]
        send_name(columns, "world/human", "human, scaled", times, waist[:, :2])
        columns.static("world/human", rr.Transform3D(translation=[0.0, -SIDE_DISTANCE, 0.0]))


def send_floor(columns: Columns, motion: Motion, side_distance: float = SIDE_DISTANCE) -> None:
    """Send a floor under where the robot goes, and under others at a distance beside it [m]."""
    room = np.array([FLOOR_MARGIN, FLOOR_MARGIN + side_distance])
    low = TILE_SIZE * np.floor((motion.com[:, :2].min(axis=0) - room) / TILE_SIZE)
    high = TILE_SIZE * np.ceil((motion.com[:, :2].max(axis=0) + room) / TILE_SIZE)
    middle, half = np.append(0.5 * (low + high), -0.012), np.append(0.5 * (high - low), 0.01)
    slab = rr.Boxes3D(half_sizes=[half], centers=[middle], colors=[COLORS["floor"]], fill_mode="solid")
    columns.static("world/floor", slab)
    across = [[[x, low[1], 0.0], [x, high[1], 0.0]] for x in np.arange(low[0], high[0] + 0.1, TILE_SIZE)]
    along = [[[low[0], y, 0.0], [high[0], y, 0.0]] for y in np.arange(low[1], high[1] + 0.1, TILE_SIZE)]
    columns.static("world/floor/grid", rr.LineStrips3D(across + along, colors=[COLORS["grid"]], radii=[0.002]))


def send_human(columns: Columns, human: Human, times: np.ndarray) -> None:
    """Send a human, drawn as its bones."""
    frames = nearest_frames(times, human.rate, human.count)
    ends = [np.stack([human.points[near][frames], human.points[far][frames]], axis=1) for near, far in BONES]
    strips = np.stack(ends, axis=1).reshape(-1, 2, 3).astype(np.float32)
    columns.static("world/human/bones", rr.LineStrips3D.from_fields(colors=[COLORS["human"]], radii=[0.018]))
    columns.over_time(
        "world/human/bones", times, rr.LineStrips3D.columns(strips=strips).partition([len(BONES)] * len(times))
    )


def send_name(columns: Columns, entity: str, name: str, times: np.ndarray, places: np.ndarray) -> None:
    """Send a name that floats over someone who moves along places on the floor (T, 2)."""
    above = np.column_stack([places, np.full(len(places), NAME_HEIGHT)]).astype(np.float32)
    label = rr.Points3D.from_fields(labels=[name], radii=[0.001], colors=[COLORS["text"]], show_labels=True)
    columns.static(f"{entity}/name", label)
    columns.over_time(f"{entity}/name", times, rr.Points3D.columns(positions=above))
