"""The command line as a user meets it: what goes wrong is one clear line, exit 2, and nothing written."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from scenarios import cli, viewer
from scenarios.inputs import clips
from scenarios.inputs.groove import groove_bvh
from scenarios.replay import RECORDING_FILE, REPORT_FILE, SIMULATED_FILE, TRACES_FILE
from sot.errors import InputError
from sot.motion import read, recognise
from sot.motion.trajectory import Motion
from tests.sot.motion.human.formats.fuzz import ENDINGS, damaged_file

UNKNOWN_SKELETON = """HIERARCHY
ROOT Blob
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  End Site
  {
    OFFSET 0 1 0
  }
}
MOTION
Frames: 2
Frame Time: 0.02
0 0 0 0 0 0
0 0 0 0 0 0
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Each test runs in an empty folder."""
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    return here


def lines(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Exit status and what went to stderr."""
    status = cli.main(arguments)
    return status, capsys.readouterr().err


def with_nan(text: str) -> str:
    *head, last = text.rstrip().split("\n")
    return "\n".join([*head, " ".join(["nan", *last.split()[1:]])]) + "\n"


BAD_CLIPS = {
    "not a BVH": "Dear diary, today I danced.\n",
    "empty": "",
    "truncated": groove_bvh()[:3000],
    "NaN in a frame": with_nan(groove_bvh()),
    "no frames": groove_bvh().split("Frames:")[0] + "Frames: 0\nFrame Time: 0.02\n",
    "unknown skeleton": UNKNOWN_SKELETON,
}


@pytest.mark.parametrize("text", BAD_CLIPS.values(), ids=BAD_CLIPS.keys())
def test_bad_clip(text, folder, capsys):
    (folder / "clip.bvh").write_text(text)
    status, said = lines(["replay", "clip.bvh"], capsys)
    assert status == cli.BAD_INPUT
    assert said.count("\n") == 1
    assert said.startswith("sot: ")
    assert "clip" in said
    assert [path.name for path in folder.iterdir()] == ["clip.bvh"]


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_damaged_file_of_any_format_is_one_line(ending, folder, capsys):
    refused = 0
    for seed in range(6):
        place = folder / f"{seed}"
        place.mkdir()
        clip, mapping = damaged_file(place, ending, seed)
        there = sorted(folder.rglob("*"))
        try:
            recognise(read(clip), mapping)
        except InputError:
            status, said = lines(["retarget", str(clip), *(["--mapping", str(mapping)] if mapping else [])], capsys)
            assert status == cli.BAD_INPUT and said.startswith("sot: ") and said.count("\n") == 1
            refused += 1
        assert sorted(folder.rglob("*")) == there
    assert refused


def test_an_unknown_skeleton_has_its_mapping_printed_to_be_completed(folder, capsys):
    (folder / "clip.bvh").write_text(groove_bvh().replace(" LeftLeg\n", " Genou\n"))
    status = cli.main(["retarget", "clip.bvh"])
    printed = capsys.readouterr()
    assert status == cli.BAD_INPUT and printed.err.count("\n") == 1
    (folder / "mapping.toml").write_text(printed.out.replace('left_knee = ""', 'left_knee = "Genou"'))
    assert "left_elbow" in printed.out
    assert cli.main(["retarget", "clip.bvh", "--duration", "0.3", "--mapping", "mapping.toml"]) == cli.DONE


BAD_STACKS = {
    "syntax": ("def stack(robot motion):\n    pass\n", "mine.py:1: "),
    "raises when loaded": ("import math\nmath.sqrt(-1)\n", "mine.py:2: ValueError"),
    "raises when composed": ("def stack(robot, motion):\n    return robot.tail\n", "mine.py:2: AttributeError"),
    "raises in the loop": (
        "from scenarios import stacks\nfrom tasks import CenterOfMass\n\n\ndef stack(robot, motion):\n"
        "    made = stacks.planted_stack(robot, motion)\n"
        "    made.add(CenterOfMass(lambda t: 1 / 0, name='mine'), level='balance')\n    return made\n",
        "mine.py:7: task 'mine': ZeroDivisionError",
    ),
    "no such point": (
        "from tasks import OperationalPoint\n\n\ndef stack(robot, motion):\n"
        "    return OperationalPoint(robot, 'tail', motion.pose('waist'))\n",
        "mine.py:5: hrp2 has no point 'tail'",
    ),
    "no function": ("stack = 3\n", "mine.py: defines no function stack(robot, motion)"),
    "wrong schedule": (
        "from scenarios.stacks import planted_stack as stack\n\n\ndef schedule(robot, motion):\n    return 3\n",
        "schedule(robot, motion) returned int, not a Schedule",
    ),
    "wrong edits": (
        "from scenarios.stacks import planted_stack as stack\n\n\ndef edits(robot, motion):\n    return [3]\n",
        "something else than Edit in it",
    ),
    "edit that does not fit": (
        "from scenarios.stacks import planted_stack as stack\nfrom sot.motion.edit import Edit\n\n\n"
        "def edits(robot, motion):\n    return [Edit('tail', 'z', by=0.1, start=0.0, end=0.5)]\n",
        "mine.py: hrp2 has no point 'tail'",
    ),
    "edit that raises": (
        "from scenarios.stacks import planted_stack as stack\nfrom sot.motion.edit import Edit\n\n\n"
        "def edits(robot, motion):\n    return [Edit('head', 'z', by=lambda t: 1 / 0, start=0.0, end=0.5)]\n",
        "mine.py:6: ZeroDivisionError",
    ),
    "wrong result": ("def stack(robot, motion):\n    return []\n", "returned list, not a Stack"),
}


@pytest.mark.parametrize(("text", "expected"), BAD_STACKS.values(), ids=BAD_STACKS.keys())
def test_bad_stack_file(text, expected, folder, capsys):
    (folder / "mine.py").write_text(text)
    status, said = lines(["replay", "groove", "--duration", "0.2", "--stack", "mine.py"], capsys)
    assert status == cli.BAD_INPUT
    assert said.count("\n") == 1
    assert expected in said
    assert not (folder / "runs").exists()


ON_HAND = '[[edit]]\npoint = "right_hand"\n'
BAD_EDITS = {
    "not TOML": ("[[edit]\n", "edits.toml: not a TOML file"),
    "something else": ("[edit]\nby = 1\n", "something else than [[edit]] tables"),
    "limb_only": (ON_HAND + "by = 0.1\nlimb_only = 1\n", "edits.toml: edit 1: limb_only is true or false, not 1"),
    "key": (ON_HAND + "by_how_much = 0.1\n", "edits.toml: edit 1 has an unknown key 'by_how_much'"),
    "nothing named": ("[[edit]]\nby = 0.1\n", "edits.toml: edit 1: give a point or a joint"),
    "point": ('[[edit]]\npoint = "tail"\naxis = "z"\nby = 0.1\nfrom = 0\nto = 1\n', "edit 1: hrp2 has no point 'tail'"),
    "joint": ('[[edit]]\njoint = "LTAIL"\nby = 10\nfrom = 0\nto = 1\n', "edit 1: hrp2 has no joint 'LTAIL'"),
    "axis": (ON_HAND + 'axis = "up"\nby = 0.1\nfrom = 0\nto = 1\n', "has no axis 'up'"),
    "a word": (ON_HAND + 'axis = "z"\nby = "high"\nfrom = 0\nto = 1\n', "by has to be a number, not 'high'"),
    "way-point": (ON_HAND + 'axis = "z"\nthrough = [[1.0]]\n', "a way-point of through is a list of 2 numbers"),
    "target": (ON_HAND + "target = [1.0, 2.0]\nfrom = 0\nto = 1\n", "target is a list of 3 numbers"),
    "time": (ON_HAND + 'axis = "z"\nby = 0.1\nfrom = 0.5\nto = 90\n', "edit 1: goes from 0.5 to 90 s"),
    "overlap": (
        2 * (ON_HAND + 'axis = "z"\nby = 0.1\nfrom = 0.5\nto = 1\n'),
        "edit 2: changes right_hand z from 0.5 to 1 s, as edit 1 does already",
    ),
    "function": (ON_HAND + 'axis = "z"\nfunction = "mine.py:up"\nfrom = 0\nto = 1\n', "mine.py: no such file"),
}


@pytest.mark.parametrize(("text", "expected"), BAD_EDITS.values(), ids=BAD_EDITS.keys())
def test_bad_edit_file(text, expected, folder, capsys):
    (folder / "edits.toml").write_text(text)
    status, said = lines(["replay", "groove", "--duration", "0.2", "--edit", "edits.toml"], capsys)
    assert status == cli.BAD_INPUT
    assert said.count("\n") == 1
    assert expected in said
    assert not (folder / "runs").exists()


BAD_ARGUMENTS = {
    "no such clip": (["replay", "grove"], "did you mean groove"),
    "robot": (["replay", "groove", "--robot", "asimo"], "asimo"),
    "solver": (["replay", "groove", "--solver", "magic"], "choose one of cascade, weighted, iktc"),
    "feet": (["replay", "groove", "--feet", "flying"], "choose one of auto, dancer, steps, planted"),
    "stack file": (["replay", "groove", "--stack", "none.py"], "none.py: no such stack file"),
    "edit file": (["replay", "groove", "--edit", "none.toml"], "none.toml: cannot be read"),
    "start": (["replay", "groove", "--start", "500"], "the clip lasts"),
    "rate": (["replay", "groove", "--rate", "3"], "--rate"),
    "push without a force": (["replay", "groove", "--push", "t=1"], "force is missing"),
    "push with a word": (["replay", "groove", "--push", "t=1 force=1,2,3 angle=4"], "'angle=4' does not go"),
    "push with a bad force": (["replay", "groove", "--push", "t=1 force=80"], "no force x,y,z: '80'"),
    "push of no body": (["replay", "groove", "--push", "t=1 force=8,0,0 body=tail", "--duration", "0.2"], "tail"),
    "mismatch": (["replay", "groove", "--mismatch", "mass=heavy"], "mass is no number: 'heavy'"),
    "mismatch out of range": (["replay", "groove", "--mismatch", "friction=2"], "friction=2: must be between"),
    "plant": (["replay", "groove", "--plant", "animal"], "unknown plant 'animal': choose one of torque, servo"),
    "feet of one number": (["replay", "groove", "--feet-compliance", "2500"], "give KX,KY or KX,KY,KZ"),
    "feet of no numbers": (["replay", "groove", "--feet-compliance", "soft,hard"], "give KX,KY or KX,KY,KZ"),
    "feet of nothing": (["replay", "groove", "--feet-compliance", "2500,0"], "positive numbers"),
    "feet without end": (["replay", "groove", "--feet-compliance", "inf,2500"], "positive numbers"),
    "feet too soft": (
        ["replay", "groove", "--feet", "planted", "--duration", "0.2", "--feet-compliance", "150,2500"],
        "150 N m/rad in roll cannot hold the robot up on 2 feet, from 0.00 s on: give more than m g l, 2",
    ),
    "stabiliser": (["replay", "groove", "--plant", "servo", "--stabiliser", "crutch"], "choose one of dcm, "),
    "suite": (["bench", "--suite", "songs"], "choose one of dance"),
    "folder of the suite": (["bench", "--suite", "dance", "--mocap", "nowhere"], "nowhere: no clips"),
    "scenario": (["run", "flying"], "choose one of sliding"),
    "scenario without a clip": (["run", "sliding", "--clip", "groove"], "sliding dances no clip"),
    "clip of a scenario": (["run", "ramos", "--clip", "grove"], "did you mean groove"),
    "option": (["replay", "groove", "--frobnicate"], "--frobnicate"),
    "command": (["dance"], "dance"),
    "nothing to replay": (["replay"], "clip"),
    "kind": (["list", "dogs"], "dogs"),
    "recording": (["view", "nowhere.rrd"], "nowhere.rrd: no such recording"),
    "motion's ending": (["retarget", "groove", "-o", "motion.txt"], "ends in .npz"),
    "motion file": (["replay", "motion.npz"], "motion.npz"),
}


@pytest.mark.parametrize(("arguments", "expected"), BAD_ARGUMENTS.values(), ids=BAD_ARGUMENTS.keys())
def test_bad_arguments(arguments, expected, folder, capsys):
    status, said = lines(arguments, capsys)
    assert status == cli.BAD_INPUT
    assert said.count("\n") == 1
    assert expected in said
    assert list(folder.iterdir()) == []


def test_unwritable_output_is_found_before_any_work(folder, capsys, monkeypatch):
    (folder / "file").write_text("in the way")
    monkeypatch.setattr(clips, "find_clip", lambda clip: pytest.fail("looked for the clip"))
    status, said = lines(["replay", "groove", "--out", "file/run"], capsys)
    assert status == cli.BAD_INPUT
    assert said.count("\n") == 1
    assert "file/run: cannot write there" in said


def test_no_network(folder, capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
    monkeypatch.setenv("PIP_RETRIES", "0")
    status, said = lines(["replay", "lafan1_dance1_subject2"], capsys)
    *told, last = said.splitlines()
    assert status == cli.BAD_INPUT
    assert "is there a network" in last
    assert [line.split()[0] for line in told] == ["Fetching"]
    assert list(folder.iterdir()) == []
    assert not [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]


def test_an_unexpected_error_is_one_line_too(capsys, monkeypatch):
    def broken(clip: str) -> Path:
        raise RuntimeError("a bug\nof two lines")

    monkeypatch.setattr(clips, "find_clip", broken)
    assert lines(["replay", "groove"], capsys) == (
        cli.FAILED,
        "sot: RuntimeError: a bug of two lines; SOT_TRACEBACK=1 shows where\n",
    )
    monkeypatch.setenv("SOT_TRACEBACK", "1")
    with pytest.raises(RuntimeError):
        cli.main(["replay", "groove"])


@pytest.mark.parametrize(
    ("kind", "expected"),
    [("clips", "lafan1_dance1_subject2"), ("robots", "hrp2_modified"), ("solvers", "iktc"), ("tasks", "Posture")],
)
def test_list(kind, expected, capsys):
    assert cli.main(["list", kind]) == cli.DONE
    assert expected in capsys.readouterr().out


def test_view_opens_what_a_run_wrote_in_a_window(folder, monkeypatch):
    (folder / RECORDING_FILE).write_bytes(b"")
    commands = []

    class Done:
        returncode = 0

    def called(command: list[str], check: bool) -> type[Done]:
        commands.append(command)
        return Done

    monkeypatch.setattr(viewer.subprocess, "run", called)
    monkeypatch.setenv("DISPLAY", ":0")
    assert cli.main(["view", "."]) == cli.DONE
    assert commands == [[sys.executable, "-m", "rerun", RECORDING_FILE]]


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux names its displays so")
@pytest.mark.parametrize("arguments", [["view", "."], ["replay", "groove", "--view"]])
def test_without_a_display_the_browser_is_named_before_any_work(arguments, folder, monkeypatch, capsys):
    (folder / RECORDING_FILE).write_bytes(b"")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    status, said = lines(arguments, capsys)
    assert (status, said.count("\n")) == (cli.BAD_INPUT, 1)
    assert "no display" in said and "--web" in said


def test_replays_a_second_of_the_clip_that_ships(folder, capsys):
    status, said = lines(["replay", "groove", "--duration", "0.5", "--out", "new/run"], capsys)
    assert (status, said) == (cli.DONE, "")
    written = [REPORT_FILE, RECORDING_FILE, SIMULATED_FILE, TRACES_FILE]
    assert sorted(path.name for path in (folder / "new/run").iterdir()) == written
    report = json.loads((folder / "new/run" / REPORT_FILE).read_text())
    assert report["clip"] == "groove"
    assert report["fell"] is False
    assert report["tracking"]["mpjpe_mm"] < 20.0
    assert report["limits"]["torque_max_excess"] == 0.0


def test_retargets_to_a_motion_that_can_be_replayed(folder, capsys):
    assert cli.main(["retarget", "groove", "--duration", "0.5", "--rate", "200", "-o", "motion.npz"]) == cli.DONE
    assert [path.name for path in folder.iterdir()] == ["motion.npz"]
    motion = Motion.load(folder / "motion.npz")
    assert motion.robot.name == "hrp2"
    assert np.isfinite(motion.q).all()
    capsys.readouterr()
    status, said = lines(["replay", "motion.npz", "--start", "1"], capsys)
    assert status == cli.BAD_INPUT and "replayed whole" in said
    assert cli.main(["replay", "motion.npz", "--rate", "500"]) == cli.DONE
    report = json.loads((folder / "runs/motion" / REPORT_FILE).read_text())
    assert report["likeness"]["segment_deg"] is None
    assert report["tracking"]["mpjpe_mm"] < 20.0
