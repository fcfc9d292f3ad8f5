"""The plan of who climbs: on the scene's treads where it has any, and on the floor where not."""

import numpy as np
import pytest

from scenarios.inputs.clips import find_clip
from scenarios.stairs.stairs import Stairs
from sot.errors import InputError
from sot.motion import Human, Plan, plan, read, recognise
from sot.motion.balance.centroidal import Centroidal
from sot.motion.feet.support import supports
from sot.robots.robot import Robot

RATE = 200.0


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def climber() -> Human:
    return recognise(read(find_clip("walk_stairs"))).slice(0.0, 4.3)


@pytest.fixture(scope="module")
def climbed(robot: Robot, climber: Human) -> Plan:
    treads = [thing.surface("top") for thing in Stairs(treads=3).things(robot)]
    return plan(climber, robot, "steps", RATE, treads=treads)


def test_the_robot_is_on_the_treads_of_the_scene(climbed: Plan) -> None:
    assert not climbed.shortfalls
    assert [phase.surfaces[foot].name for phase in climbed.motion.phases for foot in phase.feet][-2:] == [
        "tread_2/top"
    ] * 2
    for phase in climbed.motion.phases:
        for foot, pose in phase.feet.items():
            corners = np.array([pose.act(corner) for corner in climbed.motion.robot.sole(foot)])
            surface = phase.surfaces[foot]
            np.testing.assert_allclose(corners[:, 2], surface.height_at(corners[:, :2]), atol=1e-9)
            assert surface.edge_margins(corners).min() > 0.0
            planned = climbed.motion.pose(foot)(0.5 * (phase.start + phase.end))
            np.testing.assert_allclose(planned.position, pose.translation, atol=3e-3)
    rise = climbed.motion.com[-1, 2] - climbed.motion.com[0, 2]
    assert rise == pytest.approx(0.2, abs=0.03)


def test_the_zmp_is_in_the_soles_at_the_height_of_what_they_stand_on(climbed: Plan) -> None:
    motion = climbed.motion
    where = supports(motion.robot, motion.phases)
    inside = np.array(
        [
            next(one for one in reversed(where) if one.start <= t + 1e-9).polygon.margin(motion.zmp[k])
            for k, t in enumerate(motion.times)
        ]
    )
    assert np.mean(inside > 0.0) > 0.99
    last = motion.times >= motion.phases[-1].start
    state = Centroidal.along(motion.robot, motion.q[last], motion.v[last], motion.a[last])
    np.testing.assert_allclose(motion.zmp[last], state.above(np.full(last.sum(), 0.2)).zmp(), atol=1e-9)
    assert np.abs(motion.zmp[last] - state.zmp()).max() > 1e-3


def test_the_human_to_look_like_is_as_high_as_the_robot(climbed: Plan) -> None:
    toe = climbed.human.points["left_toe"][:, 2]
    assert toe[-1] - toe[0] == pytest.approx(0.2, abs=0.02)
    assert climbed.retarget["key_point_rms_m"] < 0.02


def test_the_remark_says_what_the_robot_steps_on(climbed: Plan, climber: Human, robot: Robot) -> None:
    (told,) = climbed.remarks
    assert told.endswith("; the robot steps on what the scene has there.")
    low = [thing.surface("top") for thing in Stairs(treads=1).things(robot)]
    on_floor, missing = plan(climber, robot, "steps", RATE, treads=low).remarks[:2]
    assert on_floor.endswith("; the robot steps on what the scene has there.")
    assert missing.startswith("The scene has nothing to step on as the dancer does by +0.11 m at 3.4 s")
    assert climber.remarks[0].words.endswith("; the robot steps on the floor.")


def test_planted_feet_step_on_no_tread(climber: Human, robot: Robot) -> None:
    treads = [thing.surface("top") for thing in Stairs(treads=1).things(robot)]
    with pytest.raises(InputError, match="planted feet step on no tread"):
        plan(climber, robot, "planted", RATE, treads=treads)
