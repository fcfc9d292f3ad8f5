"""A box carried after a recording."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from scenarios.inputs.clips import cache_folder
from scenarios.otani2017.carrying import clip as study
from scenarios.otani2017.carrying.carry import Carrying, carry_figures, perform
from scenarios.otani2017.carrying.clip import ClipBox, carry_after
from scenarios.otani2017.carrying.clip_figures import points_from_waist
from scenarios.replay import Replay
from sot.errors import InputError
from sot.motion.plan import PLAN_RATE
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def test_a_recording_without_a_box_is_refused(robot: Robot) -> None:
    with pytest.raises(InputError, match="holds no box to carry"):
        carry_after(Path("dance.bvh"), robot, 2.0, 500.0)


def test_an_object_leaves_where_it_lies_and_lies_again() -> None:
    at = np.zeros((50, 3))
    at[10:40, 0] = np.linspace(0.02, 1.0, 30)
    at[40:] = at[39]
    assert study._moved(at) == (9, 39)
    with pytest.raises(InputError, match="not carried anywhere"):
        study._moved(np.zeros((5, 3)))


def test_the_box_is_shown_at_the_motions_pace(robot: Robot) -> None:
    path = np.column_stack([np.linspace(0.0, 1.0, 31), np.zeros((31, 2))])  # 1 m/s for 1 s
    box = ClipBox(robot, (0.3, 0.34, 0.3), path, 0.2, 0.8, 30.0, 0.25)
    clock = 1.0 + 2.0 * np.arange(51) / PLAN_RATE  # after 1 s, at half the pace
    np.testing.assert_allclose(box.way(np.array([0.5, 2.0, 4.0]), clock)[:, 0], [0.0, 0.5, 1.0], atol=1e-9)
    assert box.moved(clock) == pytest.approx((1.4, 2.6))


def test_a_way_rests_where_it_is_lifted_and_placed() -> None:
    knots = 0.02 * np.arange(101)
    way = [pin.SE3(np.eye(3), np.array([t, 0.0, 0.5])) for t in knots.tolist()]
    rested = study._resting(way, knots, (0.5, 1.5), 0.3, 0.1)
    np.testing.assert_allclose(rested[0].translation, [0.5, 0.0, 0.1])
    np.testing.assert_allclose(rested[-1].translation, [1.5, 0.0, 0.1])
    np.testing.assert_allclose(rested[50].translation, way[50].translation)


def test_points_are_seen_from_the_waist(robot: Robot) -> None:
    q = np.tile(robot.rest, (2, 1))
    q[1, :3] += [1.0, -2.0, 0.3]
    near, far = points_from_waist(robot, q, ("head", "left_wrist"))
    np.testing.assert_allclose(near, far, atol=1e-12)
    assert near[0, 2] > 0.3


@pytest.mark.slow
def test_a_recorded_box_is_carried() -> None:
    name = "omomo_sub3_largebox_003"
    if not (cache_folder() / f"{name}.pt").is_file():
        pytest.skip(f"{name} has not been fetched; `sot run otani carry --clip {name}` does that")
    done = perform(Replay(name, "hrp2", rate=500.0), Carrying(), lambda what, share: None)
    figures = carry_figures(done)
    assert done.danced.run.fell_at_s is None and not done.schedule.failure
    assert figures["carrying"]["carried_m"] > 1.3
    assert figures["carrying"]["off_clip_max_m"] < 0.1
    assert figures["carrying"]["upper_body_mpjpe_mm"] < 30.0
    assert figures["objects"]["box"]["end_error_m"] < 0.01
