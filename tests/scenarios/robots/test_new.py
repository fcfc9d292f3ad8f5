"""`sot robot new` writes a file and a picture, tells why, checks it, and never overwrites."""

import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from scenarios import cli
from sot.robots.robot import MODELS, Robot


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    shutil.copy(MODELS / "hrp2.xml", tmp_path / "mine.xml")
    return tmp_path


def test_a_file_and_a_picture_appear_and_the_file_loads(folder, capsys):
    assert cli.main(["robot", "new", "mine.xml"]) == cli.DONE
    said = capsys.readouterr().out
    assert "lowest ends" in said and "unsure" in said and "mine.toml" in said
    assert "Checked: nothing found." in said
    assert sorted(path.name for path in folder.iterdir()) == ["mine.svg", "mine.toml", "mine.xml"]
    assert Robot.load(folder / "mine.toml").na == 30
    picture = ET.parse(folder / "mine.svg").getroot()
    words = {text.text for text in picture.iter("{http://www.w3.org/2000/svg}text")}
    assert {"left_knee", "right_hand", "waist", "centre of mass"} <= words


@pytest.mark.parametrize("there", ["mine.toml", "mine.svg"])
def test_nothing_is_overwritten(there, folder, capsys):
    (folder / there).write_text("mine")
    assert cli.main(["robot", "new", "mine.xml"]) == cli.BAD_INPUT
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and there in said and "-o" in said
    assert (folder / there).read_text() == "mine"
    assert sorted(path.name for path in folder.iterdir()) == sorted(["mine.xml", there])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.xml"], "no such model"),
        (["mine.xml", "-o", "there/mine.toml"], "no such folder"),
        (["mine.xml", "-o", "mine.txt"], "ends in .toml"),
        (["broken.xml"], "cannot be read"),
    ],
)
def test_what_cannot_be_done_is_one_line(arguments, message, folder, capsys):
    (folder / "broken.xml").write_text("<mujoco>")
    assert cli.main(["robot", "new", *arguments]) == cli.BAD_INPUT
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and message in said
    assert sorted(path.name for path in folder.iterdir()) == ["broken.xml", "mine.xml"]


def test_check_says_by_its_status_whether_something_stops_the_robot(folder, capsys):
    assert cli.main(["robot", "check", "hrp2"]) == cli.DONE
    (folder / "bad.toml").write_text('label = "nothing"\n')
    assert cli.main(["robot", "check", "bad.toml"]) == cli.BAD_INPUT
    assert "stops" in capsys.readouterr().out
