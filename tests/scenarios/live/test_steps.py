"""Live steps under physics: a dance in which the pelvis tilts as far as the legs of a stepping robot do not reach."""

from pathlib import Path

import pytest

from scenarios.inputs import clips
from scenarios.live.session import LiveRequest, follow
from scenarios.live.streaming import part_of
from sot.errors import InputError
from sot.live.clip_source import ClipSource
from sot.motion import read
from sot.robots.robot import Robot


def followed(out: Path, clip: str, start: float, seconds: float):
    try:
        path = clips.find_clip(clip)
    except InputError:
        pytest.skip(f"{clip} is not here")
    request = LiveRequest(clip, delay=0.5, feet="steps", keeps_time=False)
    source = ClipSource(part_of(read(path), start, seconds), 50.0)
    return follow(request, source, Robot.load(request.robot), out, lambda *_: None)


@pytest.mark.slow
def test_a_dance_that_crouches_and_tilts_the_pelvis_is_followed_upright(tmp_path):
    report = followed(tmp_path, "lafan1_dance1_subject2", 60.0, 11.0)
    assert not report["fell"]
    assert report["zmp"]["inside"] > 0.85
