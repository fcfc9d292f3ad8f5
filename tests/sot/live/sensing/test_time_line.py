"""Frames in order: late, doubled, lost and absurd ones are counted and not used."""

import numpy as np
import pytest

from sot.live.frame import Frame, Skeleton
from sot.live.sensing.time_line import TimeLine

JOINT = Skeleton(("a",), (-1,))


def frame(k, received, stamp=None):
    return Frame(JOINT, np.zeros((1, 3)), None, 0.02 * k if stamp is None else stamp, k, received)


def test_frames_come_out_in_order_and_on_time():
    line = TimeLine(delay=0.1)
    for k, way in enumerate((0.01, 0.03, 0.01, 0.02)):
        line.add(frame(k, 100.0 + 0.02 * k + way))
    assert line.offset == pytest.approx(100.01)
    assert [one.sequence for one in line.due(100.135)] == [0, 1]
    assert [one.sequence for one in line.due(100.2)] == [2, 3]
    assert line.age(frame(3, 100.08), 100.08) == pytest.approx(0.01)


def test_late_doubled_and_lost_frames_are_counted():
    line = TimeLine()
    for k in (0, 1, 4, 3, 4):
        line.add(frame(k, 0.02 * k + 1.0))
        line.due(2.0)
    assert line.counts == {"lost": 2, "late": 1, "doubled": 1}


def test_reordered_frames_are_put_in_order_while_they_wait():
    line = TimeLine(delay=0.1)
    for k in (2, 0, 1, 1):
        line.add(frame(k, 1.0))
    assert [one.sequence for one in line.due(1.2)] == [0, 1, 2]
    assert line.counts["doubled"] == 1


def test_an_absurd_stamp_is_not_believed_and_a_clock_set_anew_is():
    line = TimeLine()
    for k in range(5):
        line.add(frame(k, 0.02 * k))
    line.due(0.1)
    line.add(frame(5, 0.1, stamp=1e6))
    assert line.due(0.1) == [] and line.counts["absurd stamp"] == 1
    line.add(frame(6, 0.12))
    assert [one.sequence for one in line.due(0.12)] == [6]
    for k in range(40):
        line.add(frame(k, 0.2 + 0.02 * k, stamp=500.0 + 0.02 * k))
    assert line.counts["clock set anew"] == 1
    assert len(line.due(2.0)) > 10


def test_what_waits_is_bounded():
    line = TimeLine(delay=1e6)
    for k in range(3000):
        line.add(frame(k, 0.02 * k))
    assert len(line.due(1e9)) == 1000
