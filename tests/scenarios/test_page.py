"""`sot report`: what is no run is one clear line, and nothing is written."""

import json
import shutil
from pathlib import Path

import pytest

from scenarios import cli
from scenarios.replay import Replay, dance, write_outputs


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "short"
    tell = lambda what, share: None  # noqa: E731
    write_outputs(dance(Replay("groove", duration=0.1, rate=200.0), tell), folder, tell)
    return folder


def test_pages_of_one_run_and_of_two(run, tmp_path, capsys):
    first, second = (Path(shutil.copytree(run, tmp_path / "runs" / name)) for name in ("first", "second"))
    assert cli.main(["report", str(first)]) == cli.DONE
    assert str(first / "report.html") in capsys.readouterr().out
    assert cli.main(["report", str(first), str(second)]) == cli.DONE
    assert "first and second" in (tmp_path / "runs" / "comparison.html").read_text("utf-8")
    assert cli.main(["report", str(first), "-o", str(tmp_path / "new" / "page.html")]) == cli.DONE
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["page.html"]


def spoilt(run: Path, to: Path, name: str, content: str | None) -> Path:
    """A run of which one file is missing or is another."""
    shutil.copytree(run, to)
    if content is None:
        (to / name).unlink()
    else:
        (to / name).write_text(content)
    return to


def changed(run: Path, **change: object) -> str:
    return json.dumps(json.loads((run / "report.json").read_text()) | change)


def lacking(run: Path, key: str) -> str:
    report = json.loads((run / "report.json").read_text())
    del report[key]
    return json.dumps(report)


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("traces.npz", lambda run: None, "no traces.npz"),
        ("report.json", lambda run: None, "no report.json"),
        ("traces.npz", lambda run: "PK nothing", "cannot be read"),
        ("report.json", lambda run: "{", "cannot be read"),
        ("report.json", lambda run: "[]", "cannot be read"),
        ("report.json", lambda run: lacking(run, "zmp"), "no 'zmp'"),
        ("report.json", lambda run: changed(run, clip="another"), "different runs"),
        ("report.json", lambda run: changed(run, duration_s=33.0), "different runs"),
    ],
)
def test_says_what_is_wrong_with_a_run(name, content, why, run, tmp_path, capsys):
    folder = spoilt(run, tmp_path / "spoilt", name, content(run))
    before = sorted(folder.iterdir())
    assert cli.main(["report", str(folder)]) == cli.BAD_INPUT
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert why in said
    assert str(folder) in said
    assert sorted(folder.iterdir()) == before


def test_says_what_is_wrong_with_the_command(run, tmp_path, capsys):
    for arguments, why in (
        (["nowhere"], "no such folder"),
        ([str(run), str(run)], "given twice"),
        ([str(run), "-o", str(tmp_path / "page.pdf")], "ends in .html"),
        ([str(run), "-o", str(run / "report.json" / "page.html")], "cannot write"),
        ([], "Missing"),
    ):
        assert cli.main(["report", *arguments]) == cli.BAD_INPUT
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert why.lower() in said.lower()
    assert not list(tmp_path.iterdir())
