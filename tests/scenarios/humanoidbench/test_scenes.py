"""The scenes of HumanoidBench in the robot's size."""

import itertools

import mujoco
import numpy as np
import pytest

from scenarios.humanoidbench import door, push
from scenarios.humanoidbench.door import PRESSED_RAD, DoorScene, _told_force
from scenarios.humanoidbench.package import CLEAR_M, PackageScene
from scenarios.humanoidbench.push import PushScene
from scenarios.humanoidbench.size import scene_scale
from scenarios.replay import Replay
from sot.motion.carrying.fetch import box_ahead
from sot.motion.carrying.pass_door import DoorPlan
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def test_lengths_go_with_the_robots_height(robot: Robot) -> None:
    assert scene_scale(robot) == pytest.approx(1.541 / 1.8, abs=1e-3)
    scene = PushScene.of(robot, 1)
    assert scene.table().surface("top").placement.translation[2] == pytest.approx(0.9 * scene.scale)
    assert scene.thing().mass == pytest.approx(0.3)


def test_destinations_are_drawn_from_the_benchmarks_ranges(robot: Robot) -> None:
    goals = np.array([PushScene.of(robot, seed).destination for seed in range(40)]) / scene_scale(robot)
    assert (goals[:, 0] >= 0.7).all() and (goals[:, 0] <= 1.0).all() and np.ptp(goals[:, 0]) > 0.2
    assert (np.abs(goals[:, 1]) <= 0.5).all() and np.ptp(goals[:, 1]) > 0.7
    places = np.array([PackageScene.of(robot, seed).package for seed in range(40)]) / scene_scale(robot)
    assert (np.abs(places) <= 2.0).all() and (np.ptp(places, axis=0) > 3.0).all()


@pytest.mark.parametrize("seed", range(1, 9))
def test_the_robot_walks_around_the_package_and_has_it_ahead_at_its_destination(robot: Robot, seed: int) -> None:
    scene = PackageScene.of(robot, seed)
    approach = scene.approach(robot)
    way = scene.way(robot, approach[-1])
    for stop, place in ((approach[-1], scene.package), (way[-1], scene.destination)):
        ahead = box_ahead(robot) * np.array([np.cos(stop.heading), np.sin(stop.heading)])
        np.testing.assert_allclose(np.add([stop.x, stop.y], ahead), place, atol=0.01)
    points = np.vstack([[0.0, 0.0], *([stop.x, stop.y] for stop in approach[:-1])])
    for first, second in itertools.pairwise(points):
        between = first + np.linspace(0.0, 1.0, 50)[:, None] * (second - first)
        assert np.linalg.norm(between - scene.package, axis=1).min() > 0.99 * CLEAR_M * scene.scale


@pytest.mark.parametrize(("lever", "opens"), [(0.0, False), (0.5, False), (PRESSED_RAD, True)])
def test_the_door_opens_only_while_its_lever_is_down(robot: Robot, lever: float, opens: bool) -> None:
    spec = mujoco.MjSpec()
    DoorScene.of(robot, 1).thing(offset=False).add_to(spec)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[1] = lever
    for _ in range(1000):
        data.qfrc_applied[:] = 20.0, 200.0 * (lever - data.qpos[1]) - 10.0 * data.qvel[1] + 2.0 * lever
        mujoco.mj_step(model, data)
    assert bool(data.qpos[0] > 0.2) == opens
    assert opens or data.qpos[0] < 0.05


def test_the_force_on_a_hand_acts_where_the_hand_touches(robot: Robot) -> None:
    motion, names = Motion.standing(robot, 1.0, 100.0), ("left_palm", "right_hand_end")
    force, touch = np.tile([0.0, 3.0, 5.0], (2, 1)), np.tile([0.1, -0.07, 0.0], (2, 1))
    plan = DoorPlan(motion, np.array([0.0, 1.0]), np.zeros(2), dict.fromkeys(names, force), dict.fromkeys(names, touch))
    surface = robot.surface("left_palm")
    at = motion.pose("left_hand")(0.5).rotation @ surface.placement.translation + touch[0]
    told = _told_force(surface, plan).wrench(0.5)
    np.testing.assert_allclose(told, [*force[0], *np.cross(at, force[0])], atol=1e-9)


@pytest.mark.slow
def test_the_door_is_passed() -> None:
    danced, found = door.scene_run(Replay("door", "hrp2", rate=500.0), 1, lambda what, share: None)
    assert danced.run.fell_at_s is None and found["humanoidbench"]["reached"]


@pytest.mark.slow
def test_a_box_is_slid_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(push, "AHEAD_M", (0.85, 0.85))
    monkeypatch.setattr(push, "ASIDE_M", (0.0, 0.0))
    danced, found = push.scene_run(Replay("push", "hrp2", rate=500.0), 1, lambda what, share: None)
    own = found["humanoidbench"]
    assert danced.run.fell_at_s is None and own["reached"]
    assert own["pushed_m"] > 0.1 and own["off_destination_m"] < 0.03
    assert found["objects"][push.BOX]["end_tilt_deg"] < 1.0
