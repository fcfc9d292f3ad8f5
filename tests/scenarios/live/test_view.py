"""What the live view sends."""

import rerun as rr

from scenarios.live.view import LiveView
from sot.live.follower import Follower
from sot.robots.robot import Robot
from tests.sot.live.people import groove


def test_pictures_are_sent_at_their_rate(tmp_path):
    robot = Robot.load("hrp2")
    follower, stream = Follower(groove(), robot), rr.RecordingStream("test")
    stream.save(tmp_path / "view.rrd")
    view = LiveView(stream)
    for k in range(13):
        follower.update(0.01 * k)
        view(0.01 * k, robot.rest, follower)
    stream.flush()
    stream.disconnect()
    assert (tmp_path / "view.rrd").stat().st_size > 10_000
    assert view._next > 0.12
