"""The demonstrations with objects: their files are what their module writes, and their events can be found in them."""

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from scenarios.inputs.clips import find_clip, named_clips
from scenarios.inputs.handling import demonstrations
from sot.motion import read, recognise
from sot.motion.objects import event_file
from sot.motion.objects.demonstration import read_objects
from sot.motion.objects.detection import find_contacts, palm_path
from tests.scenarios.inputs.same_clip import assert_same_clip

NAMES = ("box_stand", "box_plate", "door")
DATA = Path(str(files("scenarios.inputs"))) / "data"


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demonstrations")
    for name, one in demonstrations().items():
        one.write(folder, name)
    return folder


def test_the_files_are_what_the_module_writes(written):
    produced = sorted(path.name for path in written.iterdir())
    assert len(produced) == 3 * len(NAMES)
    for ours, theirs in ((written / name, DATA / name) for name in produced):
        if ours.suffix == ".bvh":
            assert_same_clip(ours.read_text(), theirs.read_text())
        else:
            assert ours.read_bytes() == theirs.read_bytes()


@pytest.mark.parametrize("name", NAMES)
def test_the_events_are_found_in_time_and_none_is_invented(name):
    human = recognise(read(find_clip(name)))
    assert human.duration == pytest.approx(next(clip.seconds for clip in named_clips() if clip.name == name), abs=0.1)
    wanted = event_file.read(DATA / f"{name}.events.toml")
    found = find_contacts(human, read_objects(DATA / f"{name}.objects.toml"))
    assert set(found.initial) == set(wanted.initial)
    assert sorted((e.pair, e.change) for e in found.events) == sorted((e.pair, e.change) for e in wanted.events)
    times = {(event.pair, event.change): event.time for event in found.events}
    late = [times[event.pair, event.change] - event.time for event in wanted.events]
    assert np.mean(np.abs(late) <= 0.1 + 1e-9) >= 0.9


@pytest.mark.parametrize("name", NAMES)
def test_palms_lie_on_what_they_hold(name):
    human = recognise(read(find_clip(name))).resampled(30.0)
    handled, plan = read_objects(DATA / f"{name}.objects.toml"), event_file.read(DATA / f"{name}.events.toml")
    for made in (event for event in plan.events if event.pair.kind == "robot-thing" and event.change == "make"):
        path = handled.objects[made.pair.second.entity]
        local = path.local(palm_path(human, made.pair.first.surface.removesuffix("_hand"))[: len(path.position)])
        outside = np.linalg.norm(local - np.clip(local, -0.5 * path.size, 0.5 * path.size), axis=1)
        broken = [e.time for e in plan.events if e.pair == made.pair and e.change == "break"]
        span = slice(round(30 * made.time), round(30 * broken[0]) if broken else None)
        assert outside[span].max() < 0.01


def test_a_hand_that_rests_near_an_object_holds_nothing():
    handled = read_objects(DATA / "door.objects.toml")
    handled.objects["door"].position[:] = handled.objects["door"].position[0]
    handled.objects["door"].rotation[:] = handled.objects["door"].rotation[0]
    found = find_contacts(recognise(read(find_clip("door"))), handled)
    assert not found.events
