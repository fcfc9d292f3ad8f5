"""Things in the recording: where the log has them, what hands feel, and the sets of contacts over time."""

import numpy as np
import pytest

from sim.recording.forces import METRES_PER_NEWTON
from sim.recording.plots import States
from sim.recording.things import FREE, HOLDS, SUPPORTS, HandledThings, send_things, things_tab
from tests.sim.handled import HAND_FORCE_N, HELD, OPEN_DEG, TICKS, handled_log, handled_system, sets_of
from tests.sim.runs import PERIOD

FEET = ("robot/left_foot world/floor", "robot/right_foot world/floor")
GRIP = "robot/right_palm box/right"


class Sent:
    """Takes what is sent, in the place of `Columns`."""

    def __init__(self) -> None:
        self.still: list[str] = []
        self.moving: dict[str, tuple[np.ndarray, dict[str, list]]] = {}

    def static(self, entity, *archetypes):
        self.still.append(entity)

    def over_time(self, entity, times, *columns):
        parts = [part for column in columns for part in column]
        values = {str(part.component_descriptor()).split(":")[-1]: part.as_arrow_array().to_pylist() for part in parts}
        self.moving[entity] = times, values


@pytest.fixture(scope="module")
def system():
    return handled_system()


@pytest.fixture(scope="module")
def handled():
    history = [(0.0, sets_of(*FEET)), (0.25, sets_of(*FEET, GRIP)), (0.75, sets_of(FEET[0], GRIP))]
    return HandledThings(history, 0.5 * PERIOD * np.arange(TICKS))


@pytest.fixture(scope="module")
def sent(system):
    taken, rows = Sent(), np.arange(0, TICKS, 10)
    send_things(taken, handled_log(system).trimmed(), system, rows)
    return taken, rows


def test_shapes_are_where_the_log_has_their_things(system, sent):
    taken, rows = sent
    times, values = taken.moving["world/things/box/box"]
    np.testing.assert_allclose(times, PERIOD * rows)
    centres = np.array(values["centers"]).reshape(len(rows), -1, 3)
    assert centres[0, 0] == pytest.approx([0.5, 0.0, 0.9], abs=1e-6)
    expected = handled_log(system).thing_q[rows, 2]
    np.testing.assert_allclose(centres[:, 0, 2], expected, atol=1e-6)
    assert any(entity.startswith("world/things/table/") for entity in taken.still)


def test_a_leaf_turns_about_its_hinge(sent):
    taken, _ = sent
    ((_, values),) = [moving for entity, moving in taken.moving.items() if entity.startswith("world/things/door/box")]
    centres = np.array(values["centers"]).reshape(len(sent[1]), -1, 3) - [0.8, 1.0, 0.0]
    reach = np.linalg.norm(centres[..., :2], axis=2)
    np.testing.assert_allclose(reach, np.broadcast_to(reach[0], reach.shape), atol=1e-6)
    leaf = int(reach[0].argmax())
    first, last = centres[0, leaf, :2], centres[-1, leaf, :2]
    turned = np.degrees(np.arccos(first @ last / reach[0, leaf] ** 2))
    assert turned == pytest.approx(OPEN_DEG * sent[1][-1] / (TICKS - 1), abs=1e-3)


def test_an_arrow_shows_what_the_hand_feels_at_its_palm(sent):
    taken, rows = sent
    _, values = taken.moving["world/things/force/right_palm"]
    vectors = np.array(values["vectors"]).reshape(-1, 3)
    held = (rows >= HELD.start) & (rows < HELD.stop)
    np.testing.assert_allclose(vectors[held], [[0.0, -METRES_PER_NEWTON * HAND_FORCE_N, 0.0]] * held.sum(), atol=1e-6)
    assert not vectors[~held].any()


def test_the_tab_has_sets_forces_ways_and_the_clock(system, handled):
    log = handled_log(system).trimmed()
    tab = things_tab(log, system, handled)
    sets, forces, box, door, clock = tab.plots
    assert isinstance(sets, States)
    time, opening = log.time, np.linspace(0.0, OPEN_DEG, TICKS)
    assert (sets.lanes["right_palm"] == np.where(time >= 0.25, HOLDS, FREE)).all()
    assert (sets.lanes["left_foot"] == SUPPORTS).all()
    assert (sets.lanes["right_foot"] == np.where(time < 0.75, SUPPORTS, FREE)).all()
    assert list(forces.curves[0].names) == ["right_palm on box/right", "box/bottom on table/top"]
    height, angle = (
        np.interp(plot.curves[0].times, time, of) for plot, of in ((box, log.thing_q[:, 2]), (door, opening))
    )
    np.testing.assert_allclose(box.curves[0].values[:, 2], 1e3 * height, atol=1e-9)
    np.testing.assert_allclose(door.curves[0].values[:, 0], angle, atol=1e-9)
    assert clock.curves[0].values[-1] == pytest.approx(0.5 * clock.curves[0].times[-1])
