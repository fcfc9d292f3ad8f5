"""What the live view sends."""

import urllib.request

import pytest
import rerun as rr
from rerun.chunk import RrdReader

from scenarios import viewer
from scenarios.live.view import PICTURE_RATE, LiveView, shown_live
from sot.live.follower import Follower
from sot.robots.robot import Robot
from tests.sot.live.people import groove

SECONDS = 1.6


def test_robot_reference_human_and_curves_are_sent_at_their_rate(tmp_path):
    robot = Robot.load("hrp2")
    follower, stream = Follower(groove(), robot), rr.RecordingStream("test")
    stream.save(tmp_path / "view.rrd")
    view = LiveView(stream)
    for k in range(round(100 * SECONDS) + 1):
        follower.update(0.01 * k)
        view(0.01 * k, robot.rest, follower)
    stream.flush()
    stream.disconnect()
    chunks = RrdReader(tmp_path / "view.rrd").stream().to_chunks()
    rows = {}
    for chunk in chunks:
        if not chunk.is_static:
            rows[chunk.entity_path] = rows.get(chunk.entity_path, 0) + chunk.num_rows
    bodies = {who: [path for path in rows if path.startswith(f"/world/{who}/")] for who in ("robot", "reference")}
    assert len(bodies["robot"]) == len(bodies["reference"]) > 20
    (pictures,) = {rows[path] for path in bodies["robot"] + bodies["reference"]}
    assert abs(pictures - SECONDS * PICTURE_RATE) <= 2
    assert rows["/curves/error_rad"] == pictures
    assert 0 < rows["/world/human"] <= pictures and 0 < rows["/curves/frame_ms"] <= pictures  # once it is calibrated
    shapes = {chunk.entity_path for chunk in chunks if chunk.is_static}
    assert all(any(path.startswith(f"{body}/") for path in shapes) for of in bodies.values() for body in of)


def test_without_a_display_it_is_on_a_page_of_this_machine_while_it_runs(monkeypatch):
    monkeypatch.setattr(viewer, "has_display", lambda: False)
    robot, told = Robot.load("hrp2"), []
    with shown_live(told.append) as view:
        (line,) = told
        page = line.split()[-1]
        assert page.startswith("http://127.0.0.1:")
        view(0.0, robot.rest, Follower(groove(), robot))
        assert b"<html" in urllib.request.urlopen(page).read()
    with pytest.raises(OSError):  # refused or reset, by how far the page's server has gone
        urllib.request.urlopen(page)
