"""A live run that steps begins with all compiled: compiling in it stops the robot for a second or more."""

import sys

import pytest

from scenarios.inputs import clips
from scenarios.live.paced_stream import PacedStream
from scenarios.live.session import LiveRequest, follow
from scenarios.live.streaming import part_of
from sim.loop import run
from sot.motion import read
from sot.robots.robot import Robot

PACKAGES = ("solvers", "sot", "tasks", "sim")


def compiled_versions():
    """How many versions there are of each compiled function, by its name."""
    modules = [module for name, module in sys.modules.items() if name.split(".")[0] in PACKAGES]
    functions = [(f"{module.__name__}.{name}", value) for module in modules for name, value in vars(module).items()]
    return {name: len(value.signatures) for name, value in functions if hasattr(value, "signatures")}


@pytest.mark.slow
def test_nothing_is_compiled_while_a_robot_walks_live(monkeypatch, tmp_path):
    counts = []

    def counted_run(*arguments, **options):
        counts.append(compiled_versions())
        done = run(*arguments, **options)
        counts.append(compiled_versions())
        return done

    monkeypatch.setattr("scenarios.live.session.run", counted_run)
    capture = part_of(read(clips.find_clip("walk_turns")), 0.0, 5.0)
    stream = PacedStream("udp", capture, 50.0, None)
    request = LiveRequest("walk_turns", rate=500.0, delay=0.5, feet="steps", keeps_time=False)
    try:
        report = follow(request, stream, Robot.load("hrp2"), tmp_path / "out", lambda *_: None)
    finally:
        stream.close()
    before, after = counts
    assert report["steps"]["made"], report["steps"]
    assert {name: count for name, count in after.items() if count != before.get(name)} == {}
