"""The pages' code is that of example files, which run; their commands, links and named files exist."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import typer

from scenarios.cli import app
from scenarios.replay import Dance, Replay, dance
from sim.reporting.figures import Points
from tests.pages import PAGES, ROOT, blocks

EXAMPLES = ROOT / "docs" / "examples"


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def danced(**options) -> Dance:
    return dance(Replay("groove", duration=4.0, rate=500.0, **options), lambda what, share: None)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_snippets_are_parts_of_examples(page):
    files = [path.read_text("utf-8") for path in sorted(EXAMPLES.glob("*.py"))]
    for block in blocks(page, "python"):
        assert any(block in text for text in files), f"not in docs/examples:\n{block}"


def test_edits_of_the_tutorial_are_those_of_the_example():
    edits = (EXAMPLES / "edits.toml").read_text("utf-8")
    snippets = blocks(ROOT / "docs" / "tutorials" / "edit.md", "toml")
    assert snippets and all(snippet in edits for snippet in snippets)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_have_the_options_that_they_name(page):
    for block in (*blocks(page, "console"), *blocks(page, "")):
        for line in block.replace("\\\n", " ").splitlines():
            if command := re.match(r"(?:\$ )?(?:\S*/)?sot ([a-z].*)", line):
                parsed(shlex.split(command[1].split(" > ")[0], comments=True))


SOT = typer.main.get_command(app)


def parsed(words: list[str]) -> None:
    """Read a command line of `sot` as the command line does, and run nothing."""
    command = SOT
    while commands := getattr(command, "commands", {}):
        command, words = commands[words[0]], words[1:]
    words = words[: words.index("&")] if "&" in words else words
    command.make_context("sot", words)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page):
    for link in re.findall(r"\]\(([^)#]+)\)", page.read_text("utf-8")):
        if not link.startswith("http"):
            assert (page.parent / link).exists(), link


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_files_that_are_named_exist(page):
    for name in re.findall(
        r"`((?:solvers|sot|tasks|sim|scenarios|benchmarks|docs)/[\w/.-]+\.\w+)`", page.read_text("utf-8")
    ):
        assert (ROOT / name).exists(), name


@pytest.mark.slow
def test_wave_lifts_the_hand_above_the_dance():
    wave = danced(stack=EXAMPLES / "wave.py")
    assert wave.run.fell_at_s is None
    log, motion = wave.run.log.trimmed(), wave.motion
    hand = Points.of(motion.robot, log.q, ("right_hand",)).positions["right_hand"]
    off = hand - motion.track("right_hand").position[: log.ticks]
    top = np.abs(log.time - 3.75).argmin()
    np.testing.assert_allclose(off[top], [0.0, 0.0, 0.2], atol=0.01)
    before = log.time < 3.0
    assert np.linalg.norm(off[before], axis=1).max() < 0.01
    assert np.linalg.norm((log.com - motion.com[: log.ticks])[:, :2], axis=1).max() < 0.005


@pytest.mark.parametrize("notebook", sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")), ids=name_of)
def test_notebooks_are_stored_without_what_they_print(notebook):
    cells = [cell for cell in json.loads(notebook.read_text("utf-8"))["cells"] if cell["cell_type"] == "code"]
    assert cells and all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)


def test_ten_cells_are_ten():
    book = json.loads((ROOT / "docs" / "notebooks" / "stack_in_ten_cells.ipynb").read_text("utf-8"))
    assert sum(cell["cell_type"] == "code" for cell in book["cells"]) == 10
