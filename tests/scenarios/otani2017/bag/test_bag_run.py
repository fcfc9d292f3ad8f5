"""The bag under physics: home on both feet, beyond the sole on the way, by palm and hook alone."""

import pytest

from scenarios.otani2017.bag.bag import BagTrial, perform, trial_figures
from scenarios.replay import Replay


@pytest.mark.slow
def test_a_bag_beside_its_place_comes_home():
    danced, schedule = perform(Replay("bag", rate=500.0), BagTrial(seed=1), lambda what, share: None)
    figures = trial_figures(danced, schedule)
    assert danced.run.fell_at_s is None and figures["home"]
    assert figures["beyond_sole_max_m"] > 0.015
    assert figures["palm_force_error"] < 0.1
    assert figures["foreign_touches"] == []
    assert figures["bag_slip_m"] < 0.01
