"""Hands, feet and things of a demonstration in the robot's size."""

import numpy as np
import pytest

from sot.motion.objects.events import SurfaceName
from sot.motion.objects.retarget import HAND_STANDOFF, OTHER_STANDOFF
from sot.robots.size import leg_length
from tests.sot.demonstrations import box_demonstration


@pytest.fixture(scope="module")
def demo():
    return box_demonstration()


def target_of(demo, surface):
    return next((event, one) for event, one in demo.targets.items() if event.pair.first.surface == surface)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_palm_lies_flat_on_its_side_of_the_box(demo, side):
    _, target = target_of(demo, f"{side}_hand")
    palm, face = (demo.surface(SurfaceName(*name)) for name in (("robot", f"{side}_hand"), ("box", side)))
    axes = face.placement.inverse() * target.place * palm.placement
    assert axes.rotation[:, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-9)
    assert axes.translation[2] == pytest.approx(0.0, abs=1e-9)
    inside = (axes.rotation @ palm.corners.T).T + axes.translation
    assert (np.abs(inside[:, :2]) <= np.abs(face.corners[:, :2]).max(axis=0) + 1e-9).all()


def test_a_hand_waits_at_its_standoff_and_never_comes_nearer_before(demo):
    event, target = target_of(demo, "left_hand")
    standoff = HAND_STANDOFF * leg_length(demo.system.robot)
    path, box = demo.links["left_hand"], demo.things["box"]
    for t in np.arange(event.time - 1.0, event.time + 1e-9, 0.05):
        body = box.placement(t)
        gap = (path(t).position - target.away(body, 0.0).translation) @ (body.rotation @ target.normal)
        assert gap > standoff - 2e-3
    assert path(event.time).position == pytest.approx(
        target.away(box.placement(event.time), standoff).translation, abs=2e-3
    )


def test_the_box_starts_on_the_stand_and_waits_just_above_the_table(demo):
    event, target = target_of(demo, "bottom")
    above = OTHER_STANDOFF * leg_length(demo.system.robot)
    box, size = demo.things["box"], np.ptp(demo.surface(SurfaceName("box", "left")).corners_at_point[:, 2])
    stand, table = (demo.surface(SurfaceName("world", name)).placement.translation for name in ("stand", "table"))
    assert box(0.0).position[2] == pytest.approx(stand[2] + 0.5 * size, abs=1e-3)
    assert target.place.translation[2] == pytest.approx(table[2] + 0.5 * size, abs=1e-6)
    assert box(event.time).position[2] == pytest.approx(table[2] + 0.5 * size + above, abs=1e-3)


def test_a_foot_that_is_free_goes_back_and_returns(demo):
    path, robot = demo.links["right_foot"], demo.system.robot
    start = path(0.0).position
    assert path(8.0).position[0] < start[0] - 0.05 and path(8.0).position[2] > start[2] + 0.05
    event, _ = target_of(demo, "right_foot")
    above = OTHER_STANDOFF * leg_length(robot)
    assert path(event.time).position - start == pytest.approx([0.0, 0.0, above], abs=3e-3)


def test_every_set_of_supports_has_its_centre_of_mass(demo):
    for count in range(len(demo.contacts.events) + 1):
        assert demo.contacts.sets_after(count, ()).supports in demo.com
