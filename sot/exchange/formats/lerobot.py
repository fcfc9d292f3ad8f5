"""A LeRobot data set, version 3.0: a folder of Parquet files, one episode a run.

Features: observation.state is the root (xyz, quaternion xyzw) and the joints, observation.velocity the root's linear
and angular velocity in world axes and the joints', observation.contacts the feet on the floor, action the joints'
torques [N m].
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from sot.errors import InputError
from sot.exchange.checks import checked_rate, motion_of_columns
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot
from sot.text_file import read_text

VERSION = "v3.0"
CHUNK_FILES, DATA_FILE_MB, VIDEO_FILE_MB = 1000, 100, 200
FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
FIRST = FILE.format(chunk_index=0, file_index=0)
INFO = "meta/info.json"
STATE, VELOCITY, CONTACTS, ACTION = "observation.state", "observation.velocity", "observation.contacts", "action"
ROOT_NAMES = ("root_x", "root_y", "root_z", "root_qx", "root_qy", "root_qz", "root_qw")
ROOT_VELOCITY_NAMES = tuple(f"root_{kind}_{axis}" for kind in ("linear", "angular") for axis in "xyz")
COUNTERS = ("frame_index", "episode_index", "index", "task_index")


def write(motion: RobotMotion, path: Path) -> None:
    """Write a data set of one episode to a folder.

    Raises:
        InputError: the rate is no whole number, as LeRobot takes it, or the motion has no torques.
    """
    if motion.rate != round(motion.rate):
        raise InputError(f"{path}: {motion.rate:g} frames per second; LeRobot takes a whole number, name one")
    if motion.torque is None or motion.contacts is None:
        raise InputError(f"{path}: the motion has no torques and contacts, which are what LeRobot calls actions")
    joints, count = motion.robot.joints, motion.count
    columns: dict[str, tuple[tuple[str, ...], np.ndarray]] = {
        STATE: ((*ROOT_NAMES, *joints), motion.q),
        VELOCITY: ((*ROOT_VELOCITY_NAMES, *joints), np.hstack([*motion.root_velocity, motion.joint_velocities])),
        CONTACTS: (motion.robot.feet, motion.contacts),
        ACTION: (joints, motion.torque),
    }
    features: dict[str, Any] = {
        name: {"dtype": "float32", "shape": [len(names)], "names": list(names)} for name, (names, _) in columns.items()
    }
    single: dict[str, Any] = {"shape": [1], "names": None}
    features |= {"timestamp": {"dtype": "float32", **single}}
    features |= {name: {"dtype": "int64", **single} for name in COUNTERS}
    frames = np.arange(count, dtype=np.int64)
    data: dict[str, np.ndarray] = {name: values.astype(np.float32) for name, (_, values) in columns.items()}
    data["timestamp"] = (frames / motion.rate).astype(np.float32)
    data |= {name: frames if name in ("frame_index", "index") else np.zeros_like(frames) for name in COUNTERS}
    stats = {name: _stats(values) for name, values in data.items()}
    task = f"imitate {motion.name}"
    episode: dict[str, Any] = {"episode_index": 0, "tasks": [task], "length": count}
    episode |= {"data/chunk_index": 0, "data/file_index": 0, "dataset_from_index": 0, "dataset_to_index": count}
    episode |= {f"stats/{name}/{kind}": value for name, table in stats.items() for kind, value in table.items()}
    episode |= {"meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0}
    info = {
        "codebase_version": VERSION,
        "robot_type": motion.robot.name,
        "total_episodes": 1,
        "total_frames": count,
        "total_tasks": 1,
        "chunks_size": CHUNK_FILES,
        "data_files_size_in_mb": DATA_FILE_MB,
        "video_files_size_in_mb": VIDEO_FILE_MB,
        "fps": int(motion.rate),
        "splits": {"train": "0:1"},
        "data_path": f"data/{FILE}.parquet",
        "video_path": None,
        "features": features,
    }
    for folder in ("meta/episodes/chunk-000", "data/chunk-000"):
        (path / folder).mkdir(parents=True)
    _write_json(path / INFO, info)
    _write_json(path / "meta/stats.json", stats)
    pq.write_table(_task_table(task), path / "meta/tasks.parquet")
    pq.write_table(
        pa.table({name: [value] for name, value in episode.items()}), path / f"meta/episodes/{FIRST}.parquet"
    )
    pq.write_table(pa.table({name: _column(values) for name, values in data.items()}), path / f"data/{FIRST}.parquet")


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read the one episode of a data set's folder; its frame rate is the data set's.

    Raises:
        InputError: no such data set, of several episodes, or of another robot.
    """
    try:
        info: Any = json.loads(read_text(path / INFO))
        episodes, names, rate = int(info["total_episodes"]), info["features"][STATE]["names"], info["fps"]
        if episodes != 1:
            raise InputError(f"{path}: holds {episodes} episodes; expected one")
        table = pq.read_table(path / f"data/{FIRST}.parquet", columns=[STATE])
        state = np.array(table.column(STATE).to_pylist(), dtype=float)
    except (ValueError, KeyError, TypeError, OSError, pa.ArrowException) as error:
        words = " ".join(str(error).split())[:200]
        raise InputError(f"{path}: cannot be read as a data set of LeRobot {VERSION}: {words}") from None
    if not isinstance(names, list) or state.ndim != 2 or state.shape[1] != len(names) or tuple(names[:7]) != ROOT_NAMES:
        raise InputError(f"{path}: its {STATE} is not the root (x, y, z, qx, qy, qz, qw) and named joints")
    rate = checked_rate(path, rate)
    return motion_of_columns(path, robot, rate, state[:, :3], state[:, 3:7], state[:, 7:], names[7:])


def _stats(values: np.ndarray) -> dict[str, list[float]]:
    rows = values.reshape(len(values), -1).astype(float)
    found = {name: getattr(rows, name)(axis=0).tolist() for name in ("min", "max", "mean", "std")}
    return {**found, "count": [len(rows)]}


def _column(values: np.ndarray) -> pa.Array:
    if values.ndim == 1:
        return pa.array(values)
    return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])


def _task_table(task: str) -> pa.Table:
    """The tasks' table, whose index is the task in words, as pandas reads and writes it."""
    table = pa.table({"task_index": pa.array([0], pa.int64()), "task": [task]})
    column = {"field_name": "task", "name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": None}
    number = {
        **{key: "task_index" for key in ("field_name", "name")},
        **{key: "int64" for key in ("pandas_type", "numpy_type")},
        "metadata": None,
    }
    facts = {"index_columns": ["task"], "column_indexes": [], "columns": [number, column], "pandas_version": "2.0.0"}
    return table.replace_schema_metadata({"pandas": json.dumps(facts)})


def _write_json(path: Path, content: Any) -> None:
    path.write_text(json.dumps(content, indent=4) + "\n", encoding="utf-8")
