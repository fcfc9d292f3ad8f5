"""The pages for beginners run as they stand, command by command, and print what they show."""

import os
import re
import subprocess

import pytest

from tests.pages import ROOT, TUTORIALS, commands

PAGES = [ROOT / "docs" / "start.md", ROOT / "docs" / "figures.md", *TUTORIALS]
NOT_HERE = re.compile(r"make (?!dance\b)|source |sot view\b")
"""Commands that other tests run, that set up a shell, or that open a window."""
MARK = "=== command "
TIMEOUT_S = 1800.0


def words(line: str) -> str:
    """A line without the spaces that align columns."""
    return " ".join(line.split())


def test_every_tutorial_is_in_the_index():
    index = (ROOT / "docs" / "tutorials" / "index.md").read_text("utf-8")
    assert all(f"({page.name})" in index for page in TUTORIALS if page.name != "index.md")


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)], ids=lambda page: page.stem)
def test_page_runs(page):
    todo = [command for command in commands(page) if not NOT_HERE.match(command.line)]
    script = "\n".join(f"echo '{MARK}{k}'\n{command.line}" for k, command in enumerate(todo))
    shell = ["bash", "-euo", "pipefail", "-c", script]
    path = f"{ROOT / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        shell,
        cwd=ROOT,
        env={**os.environ, "PATH": path, "COLUMNS": "100"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-4000:]
    outputs = re.split(rf"^{MARK}\d+\n", done.stdout, flags=re.MULTILINE)[1:]
    for command, output in zip(todo, outputs, strict=True):
        printed = [words(line) for line in output.splitlines()]
        for line in command.shown:
            assert words(line) in printed, f"{command.line}\nshould print: {line}\nprinted:\n{output[-4000:]}"
