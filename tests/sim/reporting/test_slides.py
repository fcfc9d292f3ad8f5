"""What is said of slides, on a made-up run whose answer is known."""

import numpy as np
import pytest

from sim.log import FOOT_SLIDING
from sim.reporting import figures
from sim.reporting.slides import slide_figures, worst_of_slides
from sot.robots.robot import Robot
from tests.sim.runs import PERIOD, perfect_log, still_motion

SLID = slice(100, 201)  # ticks of the right foot
WEIGHTS = 9.81 * 58.0


@pytest.fixture(scope="module")
def motion():
    return still_motion(Robot.load("hrp2"), 2.0)


@pytest.fixture
def log(motion):
    """The right foot, and with it the robot, moves forward by 20 cm, loaded with a tenth of the weight."""
    log = perfect_log(motion).trimmed()
    log.foot_mode[SLID, 1] = FOOT_SLIDING
    log.q[SLID, 0] += np.linspace(0.0, 0.2, 101)
    log.foot_wrench[SLID, 1, 2] = 0.1 * WEIGHTS
    left = figures.Points.of(motion.robot, motion.q[:1]).positions["left_foot"][0]
    log.zmp_measured[SLID] = left[:2]
    return log


def test_a_slide_is_measured_and_is_no_slip(motion, log):
    (slide,) = slide_figures(log, motion)
    assert slide["foot"] == "right_foot"
    assert (slide["start_s"], slide["end_s"]) == pytest.approx((100 * PERIOD, 201 * PERIOD))
    assert (slide["way_m"], slide["moved_m"]) == pytest.approx((0.2, 0.2))
    assert slide["contact"] == slide["light"] == 1.0
    assert [slide[name] for name in ("load", "load_min", "load_max", "load_raw_max")] == pytest.approx([0.1] * 4)
    assert slide["zmp_inside"] == 1.0 and 0.03 < slide["zmp_min_margin_m"] < 0.1
    assert figures.contacts(log, motion)["slip_max_m"] < 0.201  # of the feet that stand, as the whole robot moved


def test_a_foot_that_hops_is_not_in_contact_though_its_mean_load_may_be_right(motion, log):
    log.foot_wrench[SLID, 1, 2] = np.where(np.arange(101) % 2, 0.2, 0.0) * WEIGHTS
    (slide,) = slide_figures(log, motion)
    assert slide["contact"] == pytest.approx(50 / 101)
    assert slide["light"] == 0.0
    assert slide["load_raw_max"] == pytest.approx(0.2)
    assert 0.09 < slide["load_min"] <= slide["load_max"] < 0.11


def test_a_zmp_that_strays_to_the_sliding_foot_is_seen(motion, log):
    right = figures.Points.of(motion.robot, motion.q[:1]).positions["right_foot"][0]
    log.zmp_measured[150] = right[:2]
    log.zmp_measured[151] = np.nan
    (slide,) = slide_figures(log, motion)
    assert slide["zmp_inside"] == pytest.approx(99 / 101)
    assert slide["zmp_min_margin_m"] == slide["zmp_raw_min_margin_m"] == -np.inf
    log.zmp_measured[151] = log.zmp_measured[149]
    (slide,) = slide_figures(log, motion)
    assert slide["zmp_raw_min_margin_m"] < -0.1 < 0.0 < slide["zmp_min_margin_m"]  # of one tick in ten


def test_of_several_slides_the_worst_counts(motion, log):
    log.foot_mode[300:321, 0] = FOOT_SLIDING
    found = slide_figures(log, motion)
    assert [slide["foot"] for slide in found] == ["right_foot", "left_foot"]
    summary = worst_of_slides(found)
    assert summary["way_m"] == pytest.approx(0.2)
    assert summary["load_max"] == pytest.approx(0.5, rel=1e-3)
    assert summary["load_min"] == pytest.approx(0.1)
    assert worst_of_slides([]) == dict.fromkeys(summary)
