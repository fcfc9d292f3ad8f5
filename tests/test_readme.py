"""The README's commands run as they stand."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NOT_HERE = re.compile(r"^(git clone|cd |make (test|slow|check)\b|\S*sot view\b)")
"""Commands that need another place, run these tests themselves, or open a window."""


def commands() -> list[str]:
    blocks = re.findall(r"^```console\n(.*?)^```", (ROOT / "README.md").read_text("utf-8"), re.MULTILINE | re.DOTALL)
    lines = "".join(blocks).replace("\\\n", " ").splitlines()
    return [line.removeprefix("$ ") for line in lines if line.startswith("$ ")]


def test_says_how_to_dance_and_how_to_test():
    assert "make dance" in commands()
    assert "make test" in commands()


@pytest.mark.slow
@pytest.mark.parametrize("command", [command for command in commands() if not NOT_HERE.match(command)])
def test_command_runs(command):
    done = subprocess.run(command, shell=True, cwd=ROOT, capture_output=True, text=True, timeout=1200, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
