"""The picture of a run."""

from types import SimpleNamespace

import numpy as np
import pytest

from scenarios.humanoidbench import picture


@pytest.mark.parametrize(("destination", "words"), [((0.8, 0.3, 0.9), "destination"), (None, "angles of the door")])
def test_it_shows_the_way_and_what_becomes_of_the_thing(destination, words, tmp_path) -> None:
    time = np.linspace(0.0, 2.0, 101)
    log = SimpleNamespace(
        time=time,
        q=np.column_stack([0.1 * time, 0.0 * time]),
        thing_q=np.column_stack([0.6 + 0.1 * time, 0.15 * time]),
        rows_at=lambda rate: np.arange(0, 101, 2),
    )
    danced = SimpleNamespace(run=SimpleNamespace(log=SimpleNamespace(trimmed=lambda: log)))
    picture.draw(tmp_path / "way.svg", danced, destination, "a box")
    drawn = (tmp_path / "way.svg").read_text()
    assert words in drawn and "seen from above" in drawn and "waist" in drawn
