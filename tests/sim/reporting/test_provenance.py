"""Command line and revision of a report, with and without git."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from sim.reporting import provenance


@pytest.fixture(autouse=True)
def fresh() -> None:
    provenance.revision.cache_clear()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            ["/usr/bin/sot", "replay", "groove", "--push", "t=1 force=8,0,0"],
            "sot replay groove --push 't=1 force=8,0,0'",
        ),
        (["/somewhere/scenarios/__main__.py", "run", "ramos"], "sot run ramos"),
        (["study.py", "7"], "study.py 7"),
        ([""], "python"),
    ],
)
def test_the_command_line_can_be_given_to_a_shell(
    monkeypatch: pytest.MonkeyPatch, words: list[str], expected: str
) -> None:
    monkeypatch.setattr(sys, "argv", words)
    assert provenance.command_line() == expected


def checkout(folder: Path) -> None:
    own = ["-c", "user.name=n", "-c", "user.email=e@e"]
    (folder / "file").write_text("a")
    for command in (["init", "-q"], ["add", "file"], [*own, "commit", "-q", "-m", "first"]):
        subprocess.run(["git", "-C", str(folder), *command], check=True)


def test_a_checkout_has_its_revision_and_says_what_was_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    checkout(tmp_path)
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    first = provenance.revision()
    assert re.fullmatch("[0-9a-f]{12}", first)
    (tmp_path / "file").write_text("b")
    provenance.revision.cache_clear()
    assert provenance.revision() == f"{first}+"


@pytest.mark.parametrize("lacking", ["git", "checkout", "history"])
def test_without_git_it_is_the_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lacking: str) -> None:
    if lacking == "git":
        checkout(tmp_path)
        monkeypatch.setenv("PATH", str(tmp_path))
    elif lacking == "history":
        (tmp_path / ".git").mkdir()
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    monkeypatch.setattr(provenance, "version", lambda _: "1.2.3")
    assert provenance.revision() == "1.2.3"
