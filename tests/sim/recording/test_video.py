"""A run as a video."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from sim.recording import video
from sot.errors import InputError
from sot.exchange.simulated_motion import SimulatedMotion
from sot.motion.human.human import SEGMENTS
from tests.sot.exchange.motions import swaying
from tests.sot.exchange.test_simulated_motion import simulated

POINTS = tuple(dict.fromkeys(name for ends in SEGMENTS.values() for name in ends))


def run_of(seconds: float) -> SimulatedMotion:
    made, count = simulated(), round(seconds * 50.0) + 1
    places = np.random.default_rng(0).uniform(0.0, 1.0, (5, len(POINTS), 3))
    return replace(
        made, q=made.q[:count], reference=made.reference[:count], human=places, human_points=POINTS, human_rate=10.0
    )


def test_without_an_encoder_it_is_one_line(tmp_path, monkeypatch):
    def nothing(name: str) -> object:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", nothing)
    with pytest.raises(InputError, match=r"humanoid-sot\[video\]"):
        video.write_video(run_of(0.1), swaying().robot, tmp_path / "run.mp4")
    assert not list(tmp_path.iterdir())


def test_without_opengl_it_is_one_line(monkeypatch):
    monkeypatch.setattr(video, "OPEN_GL", ("nothing",))
    with pytest.raises(InputError, match="OpenGL"), video.open_gl(64, 64):
        pass


def test_frames_show_the_robot(tmp_path, monkeypatch):
    av = pytest.importorskip("av")
    monkeypatch.setattr(video, "WIDTH", 160)
    monkeypatch.setattr(video, "HEIGHT", 120)
    path = tmp_path / "run.mp4"
    try:
        video.write_video(run_of(0.1), swaying().robot, path)
    except InputError as error:
        pytest.skip(str(error))
    with av.open(str(path)) as file:
        images = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
        rate = file.streams.video[0].average_rate
    assert len(images) == 4 and rate == 30
    assert images[0].shape == (120, 160, 3) and images[0].std() > 20.0
    reds = [(image[:, :, 0].astype(int) - image[:, :, 2] > 60).sum() for image in images]
    assert min(reds) > 10  # the human, in orange
