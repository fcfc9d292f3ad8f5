"""A run of a scene leaves its recording, its report and its picture."""

import json

import numpy as np
import pytest

from scenarios.cli import main
from scenarios.humanoidbench import push
from sot.motion.carrying.slide import SlidePlan
from sot.motion.objects.pose_path import PosePath
from sot.motion.trajectory import Motion


@pytest.mark.slow
def test_a_box_that_nobody_pushes_is_not_where_it_should_be(tmp_path, monkeypatch, capsys) -> None:
    def standing(self, robot, rate):
        motion = Motion.standing(robot, 0.2, rate)
        return SlidePlan(motion, "right_hand", PosePath(rate, motion.track("right_hand")))

    monkeypatch.setattr(push.PushScene, "plan", standing)
    assert main(["run", "humanoidbench", "push", "--seed", "4", "--rate", "500", "--out", str(tmp_path)]) == 0
    own = json.loads((tmp_path / "report.json").read_text())["humanoidbench"]
    assert not own["reached"] and own["pushed_m"] < 0.005
    assert own["off_destination_m"] == pytest.approx(
        np.linalg.norm(np.array(own["destination_m"]) - [0.599, 0.0, 0.856]), abs=0.01
    )
    assert (tmp_path / "way.svg").is_file()
    assert "push: not reached; the box slid by 0.00 m" in capsys.readouterr().out
