"""How long ticks took while something was held, of the same run."""

import numpy as np
import pytest

from scenarios.otani2017.otani import tick_medians
from sim.log import RunLog
from sot.motion.objects.events import ContactSets
from sot.robots import Robot


@pytest.fixture
def log():
    log = RunLog.allocate(Robot.load("hrp2"), 100)
    log.ticks = 100
    log.time[:] = 0.1 * np.arange(100)
    log.tick_us[:] = np.where((log.time >= 3.0) & (log.time < 6.0), 300.0, 200.0)
    return log


def sets(*holding):
    return ContactSets(frozenset({"left_foot"}), frozenset(), frozenset(holding), frozenset())


def test_ticks_are_told_apart_by_whether_hands_hold(log):
    history = [(0.0, sets()), (3.0, sets("left_palm")), (4.0, sets("left_palm", "right_palm")), (6.0, sets())]
    assert tick_medians(log, history) == {"held": 300.0, "without": 200.0}


def test_where_nothing_is_held_it_says_so(log):
    assert tick_medians(log, [(0.0, sets())]) == {"held": None, "without": 200.0}
