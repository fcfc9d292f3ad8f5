"""The picture of a fetched bag shows what was measured beside what was commanded."""

from types import SimpleNamespace

import numpy as np

from scenarios.otani2017.bag import picture
from scenarios.otani2017.bag.figures import HOOK, PALM


def test_forces_are_drawn_measured_and_commanded(tmp_path):
    time = np.linspace(0.0, 2.0, 51)
    log = SimpleNamespace(
        rows_at=lambda rate: np.arange(51),
        time=time,
        com=np.column_stack([0.1 + 0.05 * time, time, time]),
        thing_q=np.column_stack([time, time, 0.85 + 0.1 * time]),
        contact_names=("left_foot", PALM, HOOK),
        contact_normal=np.column_stack([time, 60.0 * time, 5.0 * time]),
        contact_commanded=np.column_stack([time, 61.0 * time, 5.0 * time]),
    )
    picture.draw(tmp_path / "bag.svg", log, SimpleNamespace(sole_edge=0.14), "a bag of 1.5 kg")
    text = (tmp_path / "bag.svg").read_text("utf-8")
    for words in ("a bag of 1.5 kg", "beyond the sole", "palm, normal force", "hook, normal force", "commanded"):
        assert words in text
