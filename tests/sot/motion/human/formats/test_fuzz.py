"""Damaged files of every format: each is a human, or one line that refuses it, in time."""

import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import read, recognise
from tests.sot.motion.human.formats.fuzz import ENDINGS, acclaim_texts, damaged_file, whole_file

QUICK, WHOLE = 25, 500  # files of each format
MAX_SECONDS = 20


@contextmanager
def time_limit(seconds: int) -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TimeoutError(f"longer than {seconds} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def outcome(folder: Path, ending: str, seed: int) -> str:
    """The line that refuses a damaged file, empty if it is a human; what else goes wrong names file and seed."""
    path, mapping = damaged_file(folder, ending, seed)
    files = sorted(folder.iterdir())
    try:
        with time_limit(MAX_SECONDS), warnings.catch_warnings():
            warnings.simplefilter("error")
            human = recognise(read(path), mapping)
    except InputError as error:
        message = str(error)
        assert message and "\n" not in message and len(message) < 4000, (ending, seed, message)
        return message
    except BaseException as error:
        error.add_note(f"{ending}, seed {seed}")
        raise
    finally:
        assert sorted(folder.iterdir()) == files, (ending, seed)
    for values in (*human.points.values(), *human.frames.values()):
        assert np.isfinite(values).all(), (ending, seed)
    return ""


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_is_damaged_is_sound_before(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"clip.{'bvh' if ending == 'toml' else ending}"
    path.write_bytes(whole_file("bvh" if ending == "toml" else ending))
    if ending == "amc":
        path.with_suffix(".asf").write_text(acclaim_texts()[0])
    mapping = tmp_path / "mapping.toml"
    mapping.write_bytes(whole_file("toml"))
    assert recognise(read(path), mapping if ending == "toml" else None).count == 12


def fuzzed(folder: Path, ending: str, seeds: range) -> tuple[int, int]:
    """How many damaged files were refused, of how many."""
    refused = 0
    for seed in seeds:
        place = folder / str(seed)
        place.mkdir()
        refused += bool(outcome(place, ending, seed))
    return refused, len(seeds)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_damaged_file_is_a_human_or_one_line(tmp_path: Path, ending: str) -> None:
    refused, of = fuzzed(tmp_path, ending, range(QUICK))
    assert 0.3 * of < refused


@pytest.mark.slow
@pytest.mark.parametrize("ending", ENDINGS)
def test_three_thousand_damaged_files_are_humans_or_one_line_each(tmp_path: Path, ending: str) -> None:
    refused, of = fuzzed(tmp_path, ending, range(WHOLE))
    assert 0.3 * of < refused < of
