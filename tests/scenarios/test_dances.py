"""Whole dances under physics, held to what they promise: upright, in balance, within limits, and still a dance."""

from pathlib import Path
from typing import Any

import pytest

from scenarios.replay import RECORDING_FILE, REPORT_FILE, Replay, replay
from tests.sot.robots import urdf_robot

MOCAP = Path(__file__).parents[2] / "../shared/mocap"

DANCES = {
    "groove": Replay("groove"),
    "groove, modified robot": Replay("groove", robot="hrp2_modified"),
    "groove, 200 Hz": Replay("groove", rate=200.0),
    "groove, weighted": Replay("groove", solver="weighted"),
    "groove, iktc": Replay("groove", solver="iktc"),
    "perfume_A": Replay(str(MOCAP / "perfume_A.bvh")),
    "perfume_A, JVRC-1": Replay(str(MOCAP / "perfume_A.bvh"), robot="jvrc1"),
    "perfume_A, modified robot": Replay(str(MOCAP / "perfume_A.bvh"), robot="hrp2_modified"),
}

LIMITS = {  # place in the report: least, greatest
    "tracking.mpjpe_mm": (0.0, 15.0),
    "likeness.upper_segment_deg": (0.0, 10.0),
    "likeness.hand_path_ratio": (0.8, 1.2),
    "zmp.inside": (0.98, 1.0),
    "contacts.slip_max_m": (0.0, 0.008),
    "contacts.sole_tilt_max_deg": (0.0, 0.5),
    "contacts.switches": (0, 0),
    "limits.position_max_excess_rad": (0.0, 1e-3),
    "limits.velocity_max_excess": (0.0, 0.02),
    "limits.torque_max_excess": (0.0, 0.0),
    "solver.infeasible_ticks": (0, 0),
}


def value(report: dict[str, Any], place: str) -> float:
    for key in place.split("."):
        report = report[key]
    return report


@pytest.mark.slow
@pytest.mark.parametrize("name", DANCES)
def test_dances_within_all_limits(name, tmp_path):
    dance = DANCES[name]
    if not (dance.clip == "groove" or Path(dance.clip).is_file()):
        pytest.skip(f"{dance.clip} is not here")
    report = replay(dance, tmp_path, lambda what, share: None)
    assert not report["fell"], report["fell_reason"]
    figures = {place: value(report, place) for place in LIMITS}
    beyond = {place: figures[place] for place, (low, high) in LIMITS.items() if not low <= figures[place] <= high}
    assert beyond == {}
    assert (tmp_path / RECORDING_FILE).stat().st_size < 2e6 * report["duration_s"]
    assert (tmp_path / REPORT_FILE).is_file()


@pytest.mark.slow
def test_light_wrists_without_armature_track(tmp_path):
    """Their compensated friction is no positive feedback: a wrist was 1 rad off its plan, all joints 9° (rms)."""
    robot = urdf_robot.write(tmp_path)
    dance = Replay("groove", robot=str(robot), rate=500.0, duration=6.0)
    report = replay(dance, tmp_path / "run", lambda what, share: None)
    assert not report["fell"]
    assert report["tracking"]["joint_rms_rad"] < 0.02
