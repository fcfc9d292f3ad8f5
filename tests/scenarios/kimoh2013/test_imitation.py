"""A real run of Kim & Oh's experiment: upright under physics, within narrowed ranges, the pelvis corrected."""

import pytest

from scenarios import cli
from scenarios.kimoh2013 import imitation
from scenarios.replay import Replay
from scenarios.studies import SCENARIOS, default_solver, run_scenario


@pytest.mark.slow
def test_imitates_with_two_joints_narrowed(tmp_path):
    report, show = run_scenario(
        "imitation",
        None,
        Replay("", solver="iktc", rate=500.0, feet="scenario"),
        tmp_path,
        lambda what, share: None,
    )
    assert show is imitation.show
    assert not report["fell"] and report["limits"]["position_max_excess_rad"] == 0.0
    assert report["tracking"]["com_rms_m"] < 0.01
    found = report["imitation"]["iktc"]
    assert found["qps_most"] == 1 and found["unsolved"] == 0
    assert found["given_up"]["feet"] == found["given_up"]["com"] == 0.0
    assert 0.05 < found["given_up"]["height"] < 0.6 and found["given_up"]["attitude"] < 0.01
    assert max(found[f"beyond_{what}"] for what in ("rad", "velocity", "acceleration")) < 1e-6
    assert found["upper_body_rad"] < report["imitation"]["cascade"]["upper_body_rad"]
    files = {"run.rrd", "report.json", "simulated.npz", "traces.npz", "imitation.svg"}
    assert {path.name for path in tmp_path.iterdir()} == files


def test_is_listed_and_meant_for_task_corrections(capsys):
    assert cli.main(["list", "scenarios"]) == cli.DONE
    listed = capsys.readouterr().out
    assert all(name in listed for name in SCENARIOS)
    assert default_solver("imitation") == "iktc" and default_solver("sliding") == default_solver("none") == "cascade"
