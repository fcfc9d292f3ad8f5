"""A scenario in a file of one's own: run, recorded, reported; what is wrong in it is one line."""

import json
import re

import numpy as np
import pytest

from scenarios import cli
from scenarios.inputs.scenario_file import load_scenario
from scenarios.replay import RECORDING_FILE, REPORT_FILE
from sot.robots import Robot

HEAD = """
import numpy as np
from dataclasses import dataclass

from scenarios import Scenario
from scenarios.stacks import planted_stack
from sot.control import MotionTask
from sot.motion import Edit, Motion


@dataclass
class Hand(MotionTask):
    def __init__(self):
        super().__init__("hand", "m/s²", "m", 100.0)

    def observe(self, tick):
        frame = tick.frame("left_hand")
        J = frame.jacobian[:3]
        return BODY


def scenario(robot, rate):
    motion = Motion.standing(robot, 0.3, rate)
    stack = planted_stack(robot, motion)
    stack.add(Hand(), "hand", before="posture")
    return RESULT
"""
WELL = "np.zeros(3), -frame.velocity[:3], J, frame.drift[:3], np.zeros(3)"


@pytest.fixture
def write(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def written(body=WELL, result="Scenario(motion, stack)", text=HEAD):
        path = tmp_path / "mine.py"
        path.write_text(text.replace("BODY", body).replace("RESULT", result), "utf-8")
        return path

    return written


def test_it_is_run_recorded_and_reported(write, tmp_path, capsys):
    pushed = ["--push", "t=0.1 force=5,0,0 duration=0.05", "--mismatch", "mass=1.02"]
    assert cli.main(["run", str(write()), "--rate", "500", *pushed]) == cli.DONE
    report = json.loads((tmp_path / "runs" / "mine" / REPORT_FILE).read_text("utf-8"))
    assert (tmp_path / "runs" / "mine" / RECORDING_FILE).stat().st_size > 10_000
    assert (report["clip"], report["fell"], report["rate_hz"]) == ("mine", False, 500.0)
    assert report["pushes"]["given"] == 1 and report["mismatch"]["mass"] == 1.02
    assert report["solver"]["invalid_ticks"] == 0


def test_nan_is_held_counted_and_remarked(write, tmp_path, capsys):
    body = WELL.replace("np.zeros(3),", "np.full(3, np.nan if 0.1 < tick.t < 0.11 else 0.0),", 1)
    assert cli.main(["run", str(write(body)), "--rate", "500"]) == cli.DONE
    report = json.loads((tmp_path / "runs" / "mine" / REPORT_FILE).read_text("utf-8"))
    assert report["solver"]["invalid_ticks"] == 4 and not report["solver"]["infeasible_ticks"]
    assert "The last torque was held in 4 ticks from 0.102 to 0.108 s: task 'hand'" in capsys.readouterr().out


def test_edits_solver_and_scene_are_taken(write):
    edit = 'Edit("right_hand", "z", by=0.05, start=0.1, end=0.2)'
    path = write(result=f"Scenario(motion, stack, edits=[{edit}], scene=lambda spec: None, solver='mine')")
    made = load_scenario(path)(Robot.load("hrp2"), 500.0)
    assert made.edits[0].source == str(path) and made.solver == "mine"
    assert made.motion.rate == 500.0 and np.isfinite(made.motion.q).all()


LINES = {
    "columns": (
        {"body": WELL.replace("J,", "J[:, :30],")},
        "task 'hand': its Jacobian has 30 columns, the robot has 36",
    ),
    "an error in a task": ({"body": WELL.replace("J,", "1 / 0,")}, "mine.py:19: task 'hand': ZeroDivisionError"),
    "an error in the function": ({"result": "Scenario(motion, nothing)"}, "mine.py:26: NameError: name 'nothing'"),
    "an error in the scene": ({"result": "Scenario(motion, stack, scene=lambda spec: spec.no)"}, "mine.py:26: Attr"),
    "something else": ({"result": "stack"}, r"mine.py: scenario\(robot, rate\) returned Stack, not a Scenario"),
    "syntax": ({"text": "def scenario(:"}, "mine.py:1: invalid syntax"),
    "no function": ({"text": "x = 1"}, r"mine.py: defines no function scenario\(robot, rate\)"),
}


@pytest.mark.parametrize(("change", "message"), LINES.values(), ids=LINES.keys())
def test_what_is_wrong_is_one_line(write, change, message, tmp_path, capsys):
    assert cli.main(["run", str(write(**change)), "--rate", "500"]) == cli.BAD_INPUT
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert re.search(message, error), error
    assert not (tmp_path / "runs").exists()


def test_there_has_to_be_such_a_file(write, capsys):
    assert cli.main(["run", "absent.py"]) == cli.BAD_INPUT
    assert "absent.py: no such file" in capsys.readouterr().err
    assert cli.main(["run", "absent"]) == cli.BAD_INPUT
    assert "or give a file (.py)" in capsys.readouterr().err
