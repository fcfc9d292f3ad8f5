"""Errors of an estimated base whose size is known, in the figures and in the recording's tab."""

import numpy as np
import pinocchio as pin
import pytest

from sim.recording.panels import run_tabs
from sim.reporting.estimator import estimate_us, estimator_figures
from sot.robots.robot import Robot
from tests.sim.runs import perfect_log, still_motion


@pytest.fixture(scope="module")
def motion():
    return still_motion(Robot.load("hrp2"), 0.5)


def estimated_log(motion, position=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0)):
    log = perfect_log(motion).trimmed()
    log.base_estimate, log.base_velocity_estimate = log.q[:, :7].copy(), log.v[:, :6].copy()
    log.base_estimate[:, :3] += position
    turned = pin.exp3(np.array(turn))
    log.base_estimate[:, 3:] = pin.Quaternion(turned).coeffs()
    log.base_velocity_estimate[:, :3] = turned.T @ velocity
    log.estimate_us[:] = 80.0
    return log


def test_figures_are_the_errors_that_were_put_in(motion):
    log = estimated_log(motion, (3e-3, 0.0, 4e-3), (0.0, 0.01, 0.02), (0.3, 0.0, 0.4))
    figures = estimator_figures(log, motion)
    assert figures["position_end_m"] == pytest.approx(5e-3) and figures["position_max_m"] == pytest.approx(5e-3)
    assert figures["tilt_rms_deg"] == pytest.approx(np.rad2deg(0.01), rel=1e-3)
    assert figures["heading_end_deg"] == pytest.approx(np.rad2deg(0.02), rel=1e-3)
    assert figures["velocity_rms_m_s"] == pytest.approx(0.5, rel=1e-3)
    assert figures["way_m"] == 0.0 and figures["position_end_share"] is None  # nobody walked
    assert estimate_us(log)["p50"] == pytest.approx(80.0)


def test_nothing_estimated_has_no_figures_and_no_tab(motion):
    log = perfect_log(motion).trimmed()
    assert set(estimator_figures(log, motion).values()) == {None} and estimate_us(log)["p50"] is None
    assert "Estimate" not in {tab.name for tab in run_tabs(log, motion, None)}


def test_the_recording_has_truth_beside_estimate(motion):
    log = estimated_log(motion, (3e-3, 0.0, 0.0), (0.0, 0.01, 0.0))
    (tab,) = (tab for tab in run_tabs(log, motion, None) if tab.name == "Estimate")
    position, _, attitude = tab.plots
    true, estimated = position.curves[0].values[0, :2]
    assert position.curves[0].names[:2] == ["x, true", "x, estimated"] and estimated - true == pytest.approx(3.0)
    assert attitude.curves[0].values[0, 1] == pytest.approx(np.rad2deg(0.01), rel=1e-3)
