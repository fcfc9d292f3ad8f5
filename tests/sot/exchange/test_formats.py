"""Every format: what is written is read back, by the project's reader and by one written from the format's page."""

import json
import pickle
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.exchange.registry import FORMATS, find_format, read_motion, readable_format
from tests.sot.exchange.motions import RATE, swaying

READABLE = [name for name, one in FORMATS.items() if one.read is not None and one.write is not None]
WITHOUT_RATE = ("unitree-csv", "soma-csv")


def written(name: str, folder: Path) -> Path:
    path = folder / f"sway{FORMATS[name].ending}"
    write = FORMATS[name].write
    assert write is not None
    write(swaying(), path)
    return path


@pytest.mark.parametrize("name", READABLE)
def test_what_is_written_is_read_back(name, tmp_path):
    motion, path = swaying(), written(name, tmp_path)
    back = read_motion(path, name, motion.robot, RATE if name in WITHOUT_RATE else None)
    assert back.rate == RATE
    assert np.abs(back.q[:, :3] - motion.q[:, :3]).max() < 1e-6
    assert np.abs(back.q[:, 7:] - motion.q[:, 7:]).max() < 1e-6
    off = Rotation.from_quat(back.q[:, 3:7]).inv() * Rotation.from_quat(motion.q[:, 3:7])
    assert off.magnitude().max() < 1e-6
    assert np.abs(back.links.position - motion.links.position).max() < 3e-6


@pytest.mark.parametrize("name", WITHOUT_RATE)
def test_a_rate_is_never_guessed(name, tmp_path):
    with pytest.raises(InputError, match="--fps"):
        read_motion(written(name, tmp_path), name, swaying().robot)


@pytest.mark.parametrize("name", [name for name in READABLE if name not in WITHOUT_RATE])
def test_a_rate_that_is_not_the_files_is_refused(name, tmp_path):
    with pytest.raises(InputError, match="--fps"):
        read_motion(written(name, tmp_path), name, swaying().robot, 30.0)


def test_names_that_are_none():
    with pytest.raises(InputError, match="choose one of unitree-csv"):
        find_format("fbx")
    with pytest.raises(InputError, match="holds no motion"):
        readable_format("contact-labels")


def test_unitree_rows_by_the_page(tmp_path):
    """No header; xyz, xyzw, joints in MuJoCo's order."""
    table, motion = np.loadtxt(written("unitree-csv", tmp_path), delimiter=","), swaying()
    assert table.shape == (motion.count, 7 + motion.robot.na)
    assert np.abs(table - motion.q).max() < 1e-8


def test_soma_rows_by_the_page(tmp_path):
    """Centimetres; degrees about fixed x, y, z; names end in _dof."""
    lines, motion = written("soma-csv", tmp_path).read_text().splitlines(), swaying()
    names = lines[0].split(",")
    assert names[:3] == ["Frame", "root_translateX", "root_translateY"]
    assert names[7:] == [f"{joint}_dof" for joint in motion.robot.joints]
    row = np.array([float(cell) for cell in lines[6].split(",")])
    assert row[0] == 5
    assert np.abs(row[1:4] - 100.0 * motion.q[5, :3]).max() < 1e-6
    x, y, z = np.deg2rad(row[4:7])
    turn = Rotation.from_rotvec([0, 0, z]) * Rotation.from_rotvec([0, y, 0]) * Rotation.from_rotvec([x, 0, 0])
    assert (turn.inv() * Rotation.from_quat(motion.q[5, 3:7])).magnitude() < 1e-8
    assert np.abs(np.deg2rad(row[7:]) - motion.q[5, 7:]).max() < 1e-8


def test_tracking_arrays_by_the_page(tmp_path):
    content, motion = np.load(written("tracking-npz", tmp_path)), swaying()
    assert content["fps"].shape == (1,) and content["joint_pos"].dtype == np.float32
    assert content["joint_pos"].shape == (motion.count, motion.robot.na)
    assert np.abs(content["body_pos_w"][:, 0] - motion.q[:, :3]).max() < 1e-6
    assert np.abs(content["body_quat_w"][:, 0] - motion.q[:, [6, 3, 4, 5]]).max() < 1e-6
    assert content["body_names"].tolist() == list(motion.links.names)
    inner = slice(1, -1)
    finite = (content["body_pos_w"][2:] - content["body_pos_w"][:-2]) * RATE / 2.0
    assert np.abs(content["body_lin_vel_w"][inner] - finite).max() < 0.01
    turns = Rotation.from_quat(content["body_quat_w"][:, -1][:, [1, 2, 3, 0]])
    spin = (turns[2:] * turns[:-2].inv()).as_rotvec() * RATE / 2.0
    assert np.abs(content["body_ang_vel_w"][inner, -1] - spin).max() < 0.01


def test_gmr_and_motion_lib_by_the_page(tmp_path):
    motion = swaying()
    gmr = pickle.loads(written("gmr-pickle", tmp_path).read_bytes())
    assert {"fps", "root_pos", "root_rot", "dof_pos", "local_body_pos", "link_body_list"} <= set(gmr)
    assert gmr["fps"] == RATE and np.array_equal(gmr["root_rot"], motion.q[:, 3:7])
    root = Rotation.from_quat(motion.q[7, 3:7]).as_matrix()
    assert np.abs(motion.q[7, :3] + gmr["local_body_pos"][7] @ root.T - motion.links.position[7]).max() < 1e-12
    library = pickle.loads(written("motion-lib", tmp_path).read_bytes())
    entry = library["sway"]
    assert entry["fps"] == 50 and isinstance(entry["fps"], int)
    assert entry["pose_aa"].shape == (motion.count, 1 + motion.robot.na, 3)
    assert np.abs(Rotation.from_rotvec(entry["pose_aa"][3, 0]).as_quat() @ motion.q[3, 3:7]) > 1.0 - 1e-12
    assert np.abs(np.linalg.norm(entry["pose_aa"][:, 1:], axis=2) - np.abs(motion.q[:, 7:])).max() < 1e-12
    assert np.array_equal(entry["contact_mask"], motion.contacts)


def test_pickles_are_read_by_any_numpy(tmp_path):
    data = written("gmr-pickle", tmp_path).read_bytes()
    assert b"numpy.core.multiarray" in data and b"numpy._core" not in data


def test_holosoma_arrays_by_the_page(tmp_path):
    content, motion = np.load(written("holosoma-npz", tmp_path)), swaying()
    assert content["joint_pos"].shape == (motion.count, motion.robot.na + 7)
    assert content["joint_vel"].shape == (motion.count, motion.robot.na + 6)
    assert content["joint_pos"].dtype == np.float64
    assert np.abs(content["joint_pos"][:, 3:7] - motion.q[:, [6, 3, 4, 5]]).max() == 0.0
    assert content["body_names"][0] == "world" and not content["body_pos_w"][:, 0].any()
    finite = (motion.q[2:, :3] - motion.q[:-2, :3]) * RATE / 2.0
    assert np.abs(content["joint_vel"][1:-1, :3] - finite).max() < 0.01


def test_manifest_by_the_page(tmp_path):
    folder, motion = written("any4hdmi", tmp_path), swaying()
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["format_version"] == 2 and manifest["qpos_dim"] == 7 + motion.robot.na
    assert manifest["timestep"] == 1.0 / RATE and manifest["num_motions"] == 1
    qpos = np.load(next((folder / manifest["motions_subdir"]).rglob("*.npz")))["qpos"]
    assert qpos.dtype == np.float32 and np.abs(qpos[:, 3:7] - motion.q[:, [6, 3, 4, 5]]).max() < 1e-6


def test_contact_labels_by_the_page(tmp_path):
    labels = np.load(written("contact-labels", tmp_path))["foot_contacts"]
    assert np.array_equal(labels, swaying().contacts)


def test_lerobot_by_the_page(tmp_path):
    folder, motion = written("lerobot", tmp_path), swaying()
    info = json.loads((folder / "meta/info.json").read_text())
    assert info["codebase_version"] == "v3.0" and info["total_frames"] == motion.count
    assert (info["chunks_size"], info["data_files_size_in_mb"]) == (1000, 100)
    table = pq.read_table(folder / info["data_path"].format(chunk_index=0, file_index=0))
    assert set(info["features"]) == set(table.column_names)
    for name in ("frame_index", "episode_index", "index", "task_index"):
        assert str(table.schema.field(name).type) == "int64"
    assert str(table.schema.field("timestamp").type) == "float"
    assert np.abs(table["timestamp"].to_numpy() - np.arange(motion.count) / RATE).max() < 1e-6
    torque = np.array(table["action"].to_pylist())
    assert np.abs(torque - motion.torque).max() < 1e-5
    assert info["features"]["action"]["names"] == list(motion.robot.joints)
    episode = pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()[0]
    assert (episode["dataset_from_index"], episode["dataset_to_index"]) == (0, motion.count)
    stats = json.loads((folder / "meta/stats.json").read_text())
    assert set(stats) == set(table.column_names)
    assert np.abs(np.array(stats["action"]["mean"]) - motion.torque.mean(axis=0)).max() < 1e-5
    tasks = pq.read_table(folder / "meta/tasks.parquet")
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["task"]


def test_joblibs_own_files_and_every_protocol(tmp_path):
    motion, path = swaying(), tmp_path / "motion.pkl"
    content = {"fps": np.float32(RATE), "root_pos": np.asfortranarray(motion.q[:, :3]), "root_rot": motion.q[:, 3:7]}
    content["dof_pos"] = motion.q[:, 7:].astype(">f8")
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        path.write_bytes(pickle.dumps(content, protocol))
        assert np.abs(read_motion(path, "gmr-pickle", motion.robot).q - motion.q).max() < 1e-12
    joblib = pytest.importorskip("joblib")
    for compression in (0, 3):
        joblib.dump(content, path, compress=compression)
        assert np.abs(read_motion(path, "gmr-pickle", motion.robot).q - motion.q).max() < 1e-12
