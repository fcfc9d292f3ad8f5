"""Figures of things: slip, forces, ways and angles of a run that was made up."""

import numpy as np
import pytest

from sim.reporting.objects import object_figures, slip
from tests.sim.handled import (
    CONTACTS,
    HAND_FORCE_N,
    HELD,
    OPEN_DEG,
    RISE_M,
    SLIP_M,
    TILT_DEG,
    handled_log,
    handled_system,
)

HAND = CONTACTS.index("right_palm on box/right")


@pytest.fixture(scope="module")
def system():
    return handled_system()


def test_figures_say_what_the_things_did(system):
    figures = object_figures(handled_log(system).trimmed(), system)
    assert list(figures) == ["box", "door"]  # the table cannot do anything
    box, door = figures["box"], figures["door"]
    assert box["mass_kg"] == system.thing("box").mass
    assert box["lifted_max_m"] == pytest.approx(RISE_M)
    assert box["end_m"] == pytest.approx([0.5, 0.0, 0.9 + RISE_M])
    assert box["end_tilt_deg"] == pytest.approx(TILT_DEG, abs=1e-6)
    assert box["hand_force_max_n"] == pytest.approx(HAND_FORCE_N)
    assert box["slip_max_m"] == pytest.approx(SLIP_M, rel=1e-6)
    assert box["end_angle_deg"] is None
    assert door["end_angle_deg"] == pytest.approx(OPEN_DEG)
    assert (door["lifted_max_m"], door["end_tilt_deg"], door["slip_max_m"], door["hand_force_max_n"]) == (None,) * 4


def test_slip_counts_only_while_all_the_load_is_there(system):
    log = handled_log(system).trimmed()
    log.contact_ramp[HELD.start : HELD.start + 25, HAND] = 0.5
    assert slip(log, system, HAND) == pytest.approx(0.5 * SLIP_M, rel=1e-6)
    log.contact_mode[:, HAND] = 0
    assert slip(log, system, HAND) == 0.0


def test_slip_is_seen_from_the_thing(system):
    """A box that turns with the hand, both as one body, has not slipped; one that comes nearer has not either."""
    log = handled_log(system).trimmed()
    box = slice(0, 7)
    log.thing_q[:, box] = log.thing_q[0, box]
    log.thing_q[HELD, 1] += np.linspace(0.0, 0.01, HELD.stop - HELD.start)  # along the face's normal
    assert slip(log, system, HAND) == pytest.approx(0.0, abs=1e-9)
