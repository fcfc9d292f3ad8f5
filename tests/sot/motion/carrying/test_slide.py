"""Which hand slides a box, and along which places."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion.carrying.slide import _Planner, slide
from sot.robots.robot import Robot

SIZE, START = (0.17, 0.17, 0.17), np.array([0.6, 0.0, 0.856])


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.mark.parametrize("aside", [0.3, -0.3])
def test_the_hand_on_the_far_side_pushes_to_the_side_and_then_ahead(robot: Robot, aside: float) -> None:
    planner = _Planner(robot, SIZE, START, np.add(START, [0.2, aside, 0.0]))
    planner.push_all(0.1)
    side = "right" if aside > 0.0 else "left"
    assert planner._hand == f"{side}_hand"
    palm, end = (robot.surface(f"{side}_{name}").placement.translation for name in ("palm", "hand_end"))
    palms = np.array([key.place.act(palm) for key in planner._keys])
    ends = np.array([key.place.act(end) for key in planner._keys])
    assert np.isclose(palms[:, 1], -np.sign(aside) * 0.085).any()  # on the box's face
    assert np.isclose(palms[:, 1], aside - np.sign(aside) * 0.085).any()
    assert np.isclose(ends[:, 0], START[0] - 0.085).any() and ends[:, 0].max() == pytest.approx(START[0] + 0.115)
    times = [key.time for key in planner._keys]
    assert (np.diff(times) > 0.0).all()


def test_no_way_at_all_is_told(robot: Robot) -> None:
    with pytest.raises(InputError, match="is where it is to be already"):
        slide(robot, SIZE, START, START, 0.1)
