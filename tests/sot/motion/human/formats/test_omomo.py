"""The reader of people who carry things."""

import io
import pickle
import sys
import types
import zipfile
from collections import OrderedDict
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import read, recognise
from sot.motion.human.formats.omomo import COLUMNS, JOINTS, PARENTS, POSITIONS, read_omomo, read_omomo_object

_Storage: Any = type("FloatStorage", (), {"__module__": "torch"})


class _Pickler(pickle.Pickler):
    """Writes a tensor as PyTorch does."""

    def persistent_id(self, obj: Any) -> Any:
        return ("storage", _Storage, "0", "cpu", 0) if isinstance(obj, _Storage) else None


class _Reduced:
    def __init__(self, rebuild: Any, arguments: tuple[Any, ...]) -> None:
        self.reduced = rebuild, arguments

    def __reduce__(self) -> Any:
        return self.reduced


def _write(path: Path, rows: np.ndarray, monkeypatch: pytest.MonkeyPatch, harm: bool = False) -> None:
    def _rebuild_tensor_v2(*arguments: Any) -> None:
        return None

    module = types.ModuleType("torch._utils")
    _rebuild_tensor_v2.__module__, _rebuild_tensor_v2.__qualname__ = "torch._utils", "_rebuild_tensor_v2"
    module._rebuild_tensor_v2 = _rebuild_tensor_v2  # type: ignore[attr-defined]
    torch = types.ModuleType("torch")
    torch.FloatStorage = _Storage  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "torch", torch)
    monkeypatch.setitem(sys.modules, "torch._utils", module)
    size = tuple(rows.shape)
    tensor = _Reduced(_rebuild_tensor_v2, (_Storage(), 0, size, (rows.shape[1], 1), False, OrderedDict()))
    buffer = io.BytesIO()
    _Pickler(buffer, protocol=2).dump(_Reduced(print, ("harm",)) if harm else tensor)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("clip/data.pkl", buffer.getvalue())
        archive.writestr("clip/data/0", rows.astype("<f4").tobytes())


def _standing() -> np.ndarray:
    """Two seconds of a person who stands, with an object that rises."""
    offsets = {
        "Hip": (0.0, 0.1, -0.1), "Knee": (0.0, 0.0, -0.4), "Ankle": (0.0, 0.0, -0.42), "Foot": (0.14, 0.0, -0.05),
        "Collar": (0.0, 0.05, 0.15), "Shoulder": (0.0, 0.12, 0.0), "Elbow": (0.0, 0.1, -0.25),
        "Wrist": (0.0, 0.05, -0.25), "Spine1": (0.0, 0.0, 0.13), "Spine2": (0.0, 0.0, 0.15), "Spine3": (0.0, 0.0, 0.07),
        "Neck": (0.0, 0.0, 0.2), "Head": (0.02, 0.0, 0.15),
    }  # fmt: skip
    places = np.zeros((len(JOINTS), 3))
    places[0] = 0.0, 0.0, 0.97
    for joint, parent in list(enumerate(PARENTS))[1:]:
        side, _, part = JOINTS[joint].rpartition("_")
        offset = np.array(offsets.get(part, (0.0, 0.0, -0.03)))
        places[joint] = places[parent] + offset * [1.0, -1.0 if side == "R" else 1.0, 1.0]
    rows = np.zeros((61, COLUMNS))
    rows[:, POSITIONS] = places.ravel()
    rows[:, 318:321] = 0.5, 0.0, 0.2
    rows[:, 320] += np.linspace(0.0, 0.5, 61)
    rows[:, 324], rows[:, 386::4] = 1.0, 1.0
    return rows


def test_the_person_is_recognised_and_the_object_goes_its_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows, path = _standing(), tmp_path / "clip.pt"
    _write(path, rows, monkeypatch)
    human, track = recognise(read(path)), read_omomo_object(path)
    assert human.rate == 30.0 and human.count == 61
    assert abs(human.leg - 0.82) < 1e-3
    assert human.points["left_wrist"][0, 1] > 0.2
    np.testing.assert_allclose(track.position[-1], [0.5, 0.0, 0.7], atol=1e-6)
    np.testing.assert_allclose(track.rotation[0], np.eye(3), atol=1e-6)


def test_a_file_that_would_run_something_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "clip.pt"
    _write(path, _standing(), monkeypatch, harm=True)
    with pytest.raises(InputError, match="more than one tensor"):
        read_omomo(path)
    assert "harm" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda rows: rows[:, :-1], "has \\(frames, 591\\)"),
        (lambda rows: np.where(np.arange(COLUMNS) == 200, np.nan, rows), "not a finite number"),
        (lambda rows: rows * (np.arange(COLUMNS) != 386), "no quaternions"),
    ],
)
def test_another_tensor_is_refused(change: Any, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "clip.pt"
    _write(path, change(_standing()), monkeypatch)
    with pytest.raises(InputError, match=message):
        read_omomo(path)


def test_what_is_no_archive_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "clip.pt"
    path.write_bytes(b"nothing")
    with pytest.raises(InputError, match="no file of PyTorch"):
        read_omomo(path)
