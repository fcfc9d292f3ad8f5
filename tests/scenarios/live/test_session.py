"""Live runs under physics, over real sockets, at the run's own time."""

import random
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenarios.inputs import clips
from scenarios.live.paced_stream import PacedStream
from scenarios.live.session import LiveRequest, follow
from scenarios.replay import RECORDING_FILE, REPORT_FILE, SIMULATED_FILE, TRACES_FILE
from sim.reporting.traces import Traces
from sot.motion import read
from sot.robots.robot import Robot

MOCAP = Path(__file__).parents[3] / "../shared/mocap"
MAX_TORQUE_STEP_NM = 28.0


def tell(what, share):
    pass


def followed(out, clip="groove", scheme="udp", rate=50.0, seconds=6.0, fault=None, robot="hrp2"):
    path = MOCAP / f"{clip}.bvh"
    if clip != "groove" and not path.is_file():
        pytest.skip(f"{clip} is not here")
    capture = read(clips.find_clip("groove") if clip == "groove" else path)
    with closing(PacedStream(scheme, capture, rate, fault)) as stream:
        request = LiveRequest(clip, robot, duration=seconds, keeps_time=False)
        return follow(request, stream, Robot.load(robot), out, tell)


@pytest.mark.slow
def test_it_is_recorded_and_reported_as_ever(tmp_path):
    report = followed(tmp_path, seconds=5.0)
    assert not report["fell"]
    assert report["zmp"]["inside"] >= 0.98
    assert report["likeness"]["upper_segment_deg"] <= 9.0
    assert report["tracking"]["mpjpe_mm"] < 15.0
    assert report["limits"]["position_max_excess_rad"] < 1e-3
    live = report["live"]
    assert live["lag_ms"] <= 120.0
    assert live["frames"]["frames"] == 251 and live["frames"]["persons"] == 1
    assert set(live["latency_ms"]) == {"received", "filtered", "solved", "commanded", "measured"}
    assert {path.name for path in tmp_path.iterdir()} == {RECORDING_FILE, REPORT_FILE, SIMULATED_FILE, TRACES_FILE}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("clip", "scheme", "rate"),
    [
        ("groove", "vmc", 50.0),
        ("groove", "rokoko", 50.0),
        ("groove", "udp", 15.0),
        ("bandai_punch", "udp", 50.0),
        ("bandai_walk", "udp", 50.0),
        ("perfume_A", "udp", 30.0),
    ],
)
def test_it_stays_upright(tmp_path, clip, scheme, rate):
    report = followed(tmp_path, clip, scheme, rate)
    assert not report["fell"], report["fell_reason"]
    assert report["zmp"]["inside"] >= 0.98


def late(frame, now):
    return [(now + 0.1 * random.Random(frame.sequence).random(), frame)]


def lost(frame, now):
    return [] if random.Random(frame.sequence).random() < 0.2 else [(now, frame)]


def gone(frame, now):
    return [] if 2.5 < now < 6.0 else [(now, frame)]


def elsewhere(frame, now):
    return [(now, replace(frame, positions=frame.positions + np.array([0.7 * (now > 3.0), 0.0, 0.0])))]


@pytest.mark.slow
@pytest.mark.parametrize("fault", [late, lost, gone, elsewhere])
def test_faults_of_the_stream_leave_it_upright_and_calm(tmp_path, fault):
    report = followed(tmp_path, fault=fault, seconds=7.5 if fault is gone else 5.0)
    assert not report["fell"], report["fell_reason"]
    traces = Traces.load(tmp_path / TRACES_FILE)
    assert traces is not None
    if fault is gone:
        assert report["live"]["held_s"] > 3.0
        assert any("held its pose" in remark for remark in report["remarks"])


@pytest.mark.slow
def test_a_stream_that_stops_ends_in_the_rest_posture_without_a_jump(tmp_path):
    from scenarios.live.live_stack import live_stack
    from scenarios.live.session import LiveCompanion
    from sim.loop import run
    from sim.world import World
    from solvers import Cascade
    from sot.control.controller import Controller
    from sot.live.follower import Follower

    robot, stop, back = Robot.load("hrp2"), 3.0, 6.5

    def stops(frame, now):
        return [(now, frame)] if now < stop or now > back else []

    with closing(PacedStream("udp", read(clips.find_clip("groove")), fault=stops)) as stream:
        follower = Follower(stream, robot)
        controller = Controller(robot, live_stack(robot, follower.reference), Cascade(), 0.002)
        companion = LiveCompanion(follower, 8.0, keeps_time=False)
        done = run(controller, World(robot, 0.002), follower.reference, None, companion)
    log = done.log.trimmed()
    assert done.fell_at_s is None
    safe = (log.time > stop + 2.5) & (log.time < back)
    assert np.abs(log.q[safe, 7:] - robot.rest[7:]).max() < 0.05
    after = (log.time[1:] > stop) & (log.time[1:] < 8.0)
    assert np.abs(np.diff(log.torque, axis=0))[after].max() <= MAX_TORQUE_STEP_NM
