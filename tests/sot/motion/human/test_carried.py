"""Who climbs stairs is put over level ground, and what each foot stood on is kept."""

import numpy as np
import pytest

from scenarios.inputs.clips import find_clip
from scenarios.inputs.walks import TREAD_RISE_M
from sot.motion import Human, read, recognise
from sot.motion.feet.stance import human_on_time_line
from sot.motion.human.human import SIDES


@pytest.fixture(scope="module")
def climber() -> Human:
    return recognise(read(find_clip("walk_stairs")))


def test_each_foot_has_the_height_of_what_it_stands_on(climber: Human) -> None:
    for levels in climber.ground.values():
        steps = np.round(levels / TREAD_RISE_M)
        stands = np.abs(levels - steps * TREAD_RISE_M) < 0.01
        assert stands.mean() > 0.7
        changes = np.diff(steps[stands])
        np.testing.assert_array_equal(changes[changes != 0.0], [1.0] * 4 + [-1.0] * 4)


def test_feet_that_stand_are_on_one_level(climber: Human) -> None:
    for side in SIDES:
        toe = climber.points[f"{side}_toe"]
        still = np.linalg.norm(np.gradient(toe, axis=0), axis=1) * climber.rate < 0.02
        assert still.mean() > 0.5
        assert np.ptp(toe[still, 2]) < 0.02
    assert np.ptp(climber.points["waist"][:, 2]) < 0.2


def test_the_way_up_a_ramp_counts_from_its_foot_on() -> None:
    """Stances low on the ramp count, where the other foot is on the floor yet."""
    human = recognise(read(find_clip("walk_ramp")))
    for side in SIDES:
        level, foot = human.ground[f"{side}_foot"], human.points[f"{side}_ankle"][:, 2]
        still = np.linalg.norm(np.gradient(human.points[f"{side}_ankle"], axis=0), axis=1) * human.rate < 0.02
        heights = np.unique(np.round(level[still], 2))
        assert 0.03 < heights[heights > 0.0].min() < 0.09 and heights.max() == pytest.approx(0.21, abs=0.01)
        assert (
            np.ptp(foot[still]) < 0.05
        )  # of a ramp of 0.21 m: the last stance, its toes 2 cm up, counts as on the floor
    assert [remark.climbed > 0.0 for remark in human.remarks] == [True]


def test_heights_go_along_with_the_clip(climber: Human) -> None:
    part = climber.slice(2.0, 3.0)
    np.testing.assert_array_equal(part.ground["left_foot"], climber.ground["left_foot"][100:251])
    assert part.scaled(0.5).ground["left_foot"].max() == pytest.approx(0.5 * part.ground["left_foot"].max())
    line = human_on_time_line(part, 100.0)
    assert len(line.ground["left_foot"]) == line.count
    (told,) = climber.remarks
    assert told.climbed == pytest.approx(4 * TREAD_RISE_M, abs=0.01)
