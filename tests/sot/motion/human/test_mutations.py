"""Damaged clips: each is read and planned, or refused in one line."""

import sys
from pathlib import Path

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import plan, read, recognise
from sot.motion.human.human import Human
from sot.robots.robot import Robot
from tests.sot.motion.human.mutations import mutated_clip


def recognised(folder: Path, seed: int) -> tuple[Human | None, str]:
    """The human of a mutated clip, or None and the message that refuses it."""
    path = folder / "clip.bvh"
    _, text = mutated_clip(seed)
    path.write_text(text)
    try:
        return recognise(read(path)), ""
    except InputError as error:
        return None, str(error)


@pytest.mark.filterwarnings("error")
def test_damaged_clips_are_humans_or_refused_in_one_line(tmp_path: Path) -> None:
    humans = 0
    for seed in range(100):
        human, message = recognised(tmp_path, seed)
        names, _ = mutated_clip(seed)
        if human is None:
            assert message and "\n" not in message, names
            continue
        humans += 1
        for values in (*human.points.values(), *human.frames.values()):
            assert np.isfinite(values).all(), (seed, names)
    assert 20 < humans < 80  # both happen


def test_a_plan_that_diverges_is_refused_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    human, _ = recognised(tmp_path, 48)
    assert human is not None

    def diverging(*_: object) -> None:
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr(sys.modules["sot.motion.plan"], "fit_limbs", diverging)
    with pytest.raises(InputError, match="clip: no motion of HRP-2-like was found for it"):
        plan(human, Robot.load("hrp2"), "planted", 200.0)


@pytest.mark.slow
def test_damaged_clips_are_planned_or_refused(tmp_path: Path) -> None:
    robot = Robot.load("hrp2")
    for seed in range(300):
        human, _ = recognised(tmp_path, seed)
        if human is None:
            continue
        try:
            found = plan(human, robot, "auto", 200.0)
        except InputError as error:
            assert "\n" not in str(error)
            continue
        assert np.isfinite(found.motion.q).all(), (seed, mutated_clip(seed)[0])
