"""The documents' Python is that of example files, and the example files run."""

import re
from pathlib import Path

import numpy as np
import pytest

from scenarios.replay import Dance, Replay, dance
from sim.reporting.figures import Points

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "docs" / "examples").glob("*.py"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def danced(**options) -> Dance:
    return dance(Replay("groove", duration=4.0, rate=500.0, **options), lambda what, share: None)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_snippets_are_parts_of_examples(page):
    files = [path.read_text("utf-8") for path in EXAMPLES]
    for block in re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL):
        assert any(block in text for text in files), f"not in docs/examples:\n{block}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for link in re.findall(r"\]\(([^)#]+)\)", page.read_text("utf-8")):
        if not link.startswith("http"):
            assert (page.parent / link).exists(), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_are_named_exist(page):
    for name in re.findall(
        r"`((?:solvers|sot|tasks|sim|scenarios|benchmarks|docs)/[\w/.-]+\.\w+)`", page.read_text("utf-8")
    ):
        assert (ROOT / name).exists(), name


def test_wave_lifts_the_hand_above_the_dance():
    wave = danced(stack=ROOT / "docs" / "examples" / "wave.py")
    assert wave.run.fell_at_s is None
    log, motion = wave.run.log.trimmed(), wave.motion
    hand = Points.of(motion.robot, log.q, ("right_hand",)).positions["right_hand"]
    off = hand - motion.track("right_hand").position[: log.ticks]
    top = np.abs(log.time - 3.75).argmin()
    np.testing.assert_allclose(off[top], [0.0, 0.0, 0.2], atol=0.01)
    before = log.time < 3.0
    assert np.linalg.norm(off[before], axis=1).max() < 0.01
    assert np.linalg.norm((log.com - motion.com[: log.ticks])[:, :2], axis=1).max() < 0.005
