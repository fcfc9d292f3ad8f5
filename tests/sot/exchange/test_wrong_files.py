"""Files of the wrong order, unit or robot, and hostile ones, are refused in one line."""

import os
import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest

from sot.errors import InputError
from sot.exchange.registry import FORMATS, read_motion
from sot.exchange.restricted_pickle import read_pickle
from tests.sot.exchange.motions import RATE, swaying


def refusal(path: Path, name: str, rate: float | None = None) -> str:
    with pytest.raises(InputError) as caught:
        read_motion(path, name, swaying().robot, rate)
    said = str(caught.value)
    assert "\n" not in said
    return said


def table_of(tmp_path: Path, table: np.ndarray) -> Path:
    path = tmp_path / "motion.csv"
    np.savetxt(path, table, delimiter=",")
    return path


def test_isaacs_order_read_as_mujocos_and_back(tmp_path):
    for written, read, other in (
        ("tracking-npz", "tracking-npz-isaac", "--from tracking-npz"),
        ("tracking-npz-isaac", "tracking-npz", "--from tracking-npz-isaac"),
    ):
        path = tmp_path / "motion.npz"
        FORMATS[written].write(swaying(), path)
        said = refusal(path, read)
        assert "beyond its range" in said or other in said


def test_holosoma_read_as_mjlabs_and_back(tmp_path):
    path = tmp_path / "motion.npz"
    FORMATS["holosoma-npz"].write(swaying(), path)
    assert "--from holosoma-npz" in refusal(path, "tracking-npz")
    FORMATS["tracking-npz"].write(swaying(), path)
    assert "--from tracking-npz" in refusal(path, "holosoma-npz")


def test_wxyz_read_as_xyzw(tmp_path):
    table = swaying().q.copy()
    table[:, 3:7] = table[:, [6, 3, 4, 5]]
    assert "upside down" in refusal(table_of(tmp_path, table), "unitree-csv", RATE)


def test_degrees_centimetres_and_other_joints(tmp_path):
    motion = swaying()
    table = motion.q.copy()
    table[:, 7:] = np.rad2deg(table[:, 7:])
    assert "degrees" in refusal(table_of(tmp_path, table), "unitree-csv", RATE)
    table = motion.q.copy()
    table[:, :3] *= 100.0
    assert "unit" in refusal(table_of(tmp_path, table), "unitree-csv", RATE)
    assert "columns" in refusal(table_of(tmp_path, motion.q[:, :-1]), "unitree-csv", RATE)


def test_tables_that_are_none(tmp_path):
    path = tmp_path / "motion.csv"
    for text in ("", "1,2\n3\n", "a,b\n1,2\n", "1,2,x\n"):
        path.write_text(text)
        refusal(path, "unitree-csv", RATE)
        refusal(path, "soma-csv", RATE)
    FORMATS["soma-csv"].write(swaying(), path)
    assert "soma-csv" in refusal(path, "unitree-csv", RATE)
    table = swaying().q.copy()
    table[3, 9] = np.nan
    assert "finite" in refusal(table_of(tmp_path, table), "unitree-csv", RATE)


class Hostile:
    """Leaves a file where it is unpickled."""

    def __init__(self, target: Path) -> None:
        self.target = target

    def __reduce__(self):
        return os.mkdir, (str(self.target),)


@pytest.mark.parametrize("name", ["gmr-pickle", "motion-lib"])
def test_a_pickle_that_runs_something(name, tmp_path):
    path, target = tmp_path / "motion.pkl", tmp_path / "run"
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        path.write_bytes(pickle.dumps({"fps": 30.0, "root_pos": Hostile(target)}, protocol))
        assert "may hold nothing but data" in refusal(path, name)
    assert not target.exists()


def test_pickles_that_reach_for_more():
    hostile = {
        "getattr": b"\x80\x02cbuiltins\ngetattr\n.",
        "eval": b"\x80\x02cbuiltins\neval\n.",
        "numpy's own loader": b"\x80\x02cnumpy\nload\n.",
        "runstring": b"\x80\x02cnumpy.testing._private.utils\nrunstring\n.",
        "a class's attributes": b"\x80\x02cjoblib.numpy_pickle\nNumpyArrayWrapper\n}U\x05shapeK\x01sb.",
        "a function's defaults": b"\x80\x02c_codecs\nencode\nN}U\x0c__defaults__K\x01s\x86b.",
        "dotted": b"\x80\x04\x8c\x05numpy\x8c\x10ndarray.__class__\x93.",
        "persistent": b"\x80\x02Pfile\n.",
        "extension": b"\x80\x02\x82\x01.",
    }
    assert hostile
    for what, data in hostile.items():
        path = Path(os.devnull)
        with pytest.raises(InputError):
            _read_bytes(data, path)
            pytest.fail(what)


def _read_bytes(data: bytes, path: Path) -> object:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "motion.pkl"
        path.write_bytes(data)
        return read_pickle(path, "a motion")


def test_a_damaged_pickle_at_every_length(tmp_path):
    path = tmp_path / "motion.pkl"
    FORMATS["gmr-pickle"].write(swaying(frames=3), path)
    data = path.read_bytes()
    for length in (*range(0, 400, 7), len(data) - 1):
        path.write_bytes(data[:length])
        refusal(path, "gmr-pickle")


@pytest.mark.parametrize("name", ["tracking-npz", "holosoma-npz", "qpos-npz"])
def test_an_npz_that_is_damaged_or_holds_objects(name, tmp_path):
    path, target = tmp_path / "motion.npz", tmp_path / "run"
    np.savez(path, fps=np.array([Hostile(target)], dtype=object), joint_pos=np.zeros(3), qpos=np.zeros((3, 3)))
    refusal(path, name)
    assert not target.exists()
    FORMATS[name].write(swaying(), path)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    refusal(path, name)
    path.write_bytes(b"no zip")
    refusal(path, name)
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("qpos.npy", b"\x93NUMPY\x01\x00v\x00{'descr': __import__('os').mkdir('x')}\n")
    refusal(path, name)


@pytest.mark.parametrize("name", ["any4hdmi", "lerobot"])
def test_folders_that_are_none(name, tmp_path):
    folder = tmp_path / "set"
    folder.mkdir()
    refusal(folder, name)
    meta = folder / ("manifest.json" if name == "any4hdmi" else "meta/info.json")
    meta.parent.mkdir(exist_ok=True)
    for text in ("{", "[]", "{}", '{"qpos_names": 1, "timestep": "x", "motions_subdir": 1, "total_episodes": []}'):
        meta.write_text(text)
        refusal(folder, name)
    refusal(tmp_path / "nothing", name)
