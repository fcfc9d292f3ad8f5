"""The project as others install it: built, put into an environment of its own, and danced with outside the checkout."""

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from tests.pages import ROOT

VERSIONS = ("3.11", "3.12", "3.13")
TIMEOUT_S = 1200.0


def ran(*command: str | Path, cwd: Path, **variables: str) -> str:
    """What a command prints; it knows nothing of this checkout."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PYENV"))}
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={**clean, **variables},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done.stdout


def interpreter(version: str) -> str | None:
    """A Python of that version on this machine: the one that runs, or one that is on the path and starts."""
    if sys.version_info[:2] == tuple(map(int, version.split("."))):
        return sys.executable
    found = shutil.which(f"python{version}")
    works = found and subprocess.run([found, "-c", "import venv"], capture_output=True, check=False).returncode == 0
    return found if works else None


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """A wheel that was built from the unpacked source distribution, as a packager does."""
    folder = tmp_path_factory.mktemp("dist")
    build = (sys.executable, "-m", "hatchling", "build", "-d", folder)
    ran(*build, "-t", "sdist", cwd=ROOT)
    (archive,) = folder.glob("*.tar.gz")
    with tarfile.open(archive) as source:
        source.extractall(folder, filter="data")
    ran(*build, "-t", "wheel", cwd=folder / archive.name.removesuffix(".tar.gz"))
    (built,) = folder.glob("*.whl")
    assert built.name.split("-")[1] == archive.name.removesuffix(".tar.gz").split("-")[1]  # an sdist knows its version
    return built


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_installed_wheel_dances(wheel, version, tmp_path):
    python = interpreter(version)
    if python is None:
        pytest.skip(f"no Python {version} here")
    pins = re.findall(r"^([\w.-]+==[^\\\n]+)", (ROOT / "requirements.lock").read_text("utf-8"), re.MULTILINE)
    (tmp_path / "constraints.txt").write_text("\n".join(pins), "utf-8")
    uv, clean = (sys.executable, "-m", "uv"), tmp_path / "clean"
    ran(*uv, "venv", "--no-python-downloads", "--python", python, clean, cwd=tmp_path)
    ran(*uv, "pip", "install", "--python", clean, "--no-build", "--constraint", "constraints.txt", wheel, cwd=tmp_path)
    sot = clean / "bin" / "sot"
    # Loops are left to Python: compiling them takes a minute, and the quick tests have done that.
    ran(
        sot,
        "replay",
        "groove",
        "--duration",
        "0.5",
        "--rate",
        "200",
        "--out",
        "run",
        cwd=tmp_path,
        NUMBA_DISABLE_JIT="1",
    )
    report = json.loads((tmp_path / "run" / "report.json").read_text("utf-8"))
    assert report["fell"] is False
    assert report["revision"] == wheel.name.split("-")[1]
    ran(sot, "report", "run", cwd=tmp_path)
