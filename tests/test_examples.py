"""The numbered examples: short, on the public API, and what each says happens."""

import ast
import runpy
from pathlib import Path

import numpy as np
import pytest

from scenarios.inputs.scenario_file import load_scenario
from sim import World, run
from sim.reporting.figures import Points
from solvers import Cascade
from sot.control import Controller
from sot.robots import Robot

FOLDER = Path(__file__).parents[1] / "docs" / "examples"
EXAMPLES = sorted(FOLDER.glob("[01]*.py"))
LONGEST = 25  # lines, without blanks and comments
PACKAGES = {"solvers", "sot", "tasks", "sim", "scenarios"}
PUBLIC = {
    *("solvers", "sot.control", "sot.hardware", "sot.motion", "sot.robots", "tasks", "sim", "scenarios"),
    "scenarios.stacks",
}


def ran(name):
    return runpy.run_path(str(FOLDER / name))


def point(example, name):
    """Path of a point over a run (T, 3)."""
    log = example["done"].log.trimmed()
    return Points.of(example["robot"], log.q, (name,)).positions[name]


def test_all_fifteen_are_there():
    assert [path.name[:2] for path in EXAMPLES] == [f"{k:02}" for k in range(1, 16)]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_short_and_on_the_public_api_alone(path):
    text = path.read_text("utf-8")
    assert sum(bool(line.strip()) and not line.strip().startswith("#") for line in text.splitlines()) <= LONGEST
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.module.split(".")[0] in PACKAGES:
            assert node.module in PUBLIC, node.module
        if isinstance(node, ast.Attribute):
            assert not node.attr.startswith("_"), node.attr


def test_01_stands():
    example = ran("01_stand.py")
    q, v = example["world"].state()
    np.testing.assert_allclose(q, example["robot"].rest, atol=0.005)
    assert np.abs(v).max() < 0.01
    load = sum(wrench[2] for wrench in example["world"].foot_wrenches().values())
    assert load == pytest.approx(9.81 * example["robot"].mass, rel=0.01)


def test_02_brings_one_hand_to_the_other():
    example = ran("02_own_task.py")
    assert example["done"].fell_at_s is None
    apart = point(example, "right_hand") - point(example, "left_hand")
    assert np.linalg.norm(apart[0] - example["WANTED"]) > 0.3
    np.testing.assert_allclose(apart[-1], example["WANTED"], atol=0.005)


def test_03_stops_the_hand_under_the_ceiling():
    example = ran("03_own_limit.py")
    assert example["done"].fell_at_s is None
    hand = point(example, "right_hand")
    assert hand[0, 2] < 0.7
    assert example["HEIGHT"] - 0.005 < hand[-1, 2] and hand[:, 2].max() < example["HEIGHT"] + 0.001
    np.testing.assert_allclose(hand[-1, :2], [0.3, -0.3], atol=0.01)  # it goes where it is free to


def test_04_takes_the_load_off_the_toes():
    example = ran("04_own_force_limit.py")
    assert example["done"].fell_at_s is None
    wrenches, soles = example["world"].foot_wrenches(), example["robot"].soles
    behind = {foot: -wrench[4] / wrench[2] for foot, wrench in wrenches.items()}  # centre of pressure, x
    spared, middle = example["FOOT"], {foot: sole[:, 0].mean() for foot, sole in soles.items()}
    # The floor's force with no more than MOST of it at the toes, in MuJoCo's contacts.
    heel, toe = soles[spared][:, 0].min(), soles[spared][:, 0].max()
    at_toes = wrenches[spared][2] * (behind[spared] - heel) / (toe - heel)
    assert at_toes < 1.5 * example["MOST"] < 0.2 * wrenches[spared][2]
    assert behind["right_foot"] - middle["right_foot"] > behind[spared] - middle[spared] + 0.05


def test_05_moves_the_upper_body_alone():
    example = ran("05_upper_body.py")
    robot, log = example["robot"], example["done"].log.trimmed()
    assert example["done"].fell_at_s is None
    legs = list(robot.groups["legs"])
    upper = [k for k in range(robot.na) if k not in legs]
    joints, danced = log.q[:, 7:], example["dance"].q[: len(log.q), 7:]
    assert np.ptp(danced[:, upper], axis=0).max() > 0.5
    assert np.abs(joints - danced)[len(joints) // 2 :, upper].max() < 0.05
    assert np.abs(joints[:, legs] - robot.rest[7:][legs]).max() < 0.2


def test_06_dances_in_a_loop_without_the_world():
    example = ran("06_plain_mujoco.py")
    q, _ = example["state"].read()
    motion = example["motion"]
    assert np.ptp(motion.q[:, 7:], axis=0).max() > 0.5
    np.testing.assert_allclose(q[7:], motion.q[-1, 7:], atol=0.02)
    assert q[2] == pytest.approx(motion.q[-1, 2], abs=0.005)


def test_07_survives_a_push_and_a_heavier_body():
    example = ran("07_world.py")
    assert example["done"].fell_at_s is None
    assert 0.003 < example["sway"].max() < 0.08 and example["sway"][-1] < 0.01


def test_08_reaches_over_a_table():
    robot = Robot.load("hrp2")
    made = load_scenario(FOLDER / "08_table.py")(robot, 500.0)
    world = World(robot, 0.002, scene=made.scene)
    assert world.model.geom("table").conaffinity[0]
    done = run(Controller(robot, made.stack, Cascade(), 0.002), world, made.motion)
    assert done.fell_at_s is None
    log = done.log.trimmed()
    hand = Points.of(robot, log.q, ("right_hand",)).positions["right_hand"]
    np.testing.assert_allclose(hand[[500, 1500]] - hand[0], [[0.05, 0.0, 0.15]] * 2, atol=0.01)
    np.testing.assert_allclose(hand[[1000, -1]], hand[[0, 0]], atol=0.01)


def test_09_eases_a_task_in_and_out():
    example = ran("09_task_added_live.py")
    torques, places = np.array(example["torques"]), np.array(example["places"])
    steps = np.abs(np.diff(torques, axis=0)).max(axis=1)
    assert steps[245:255].max() < 2.0 and steps[1245:1255].max() < 2.0  # N m, as the hand comes and goes
    assert steps.max() < 20.0
    np.testing.assert_allclose(places[1249], [0.35, -0.3, 0.95], atol=0.01)
    np.testing.assert_allclose(places[-1], places[0], atol=0.03)
    assert example["stack"].level_of(example["hand"]) is None
    assert example["world"].state()[0][2] == pytest.approx(example["robot"].rest[2], abs=0.005)


def assert_bows_and_waves(example, contacts):
    done, robot, motion = example["done"], example["robot"], example["motion"]
    log = done.log.trimmed()
    assert done.fell_at_s is None and log.contact_names == contacts
    assert np.abs(log.com - motion.com[: len(log.com)])[:, :2].max() < 0.005
    assert (log.contact_normal[100:].min(axis=0) > 0.2 * 9.81 * robot.mass).all()  # each foot carries its share
    assert np.abs(np.diff(log.torque, axis=0)).max() < 2.0
    hand, chest = point(example, "right_hand"), Points.of(robot, log.q, ("head_top",)).positions["head_top"]
    assert np.ptp(hand[:, 2]) > 0.2 and np.ptp(chest[:, 0]) > 0.1


@pytest.mark.slow
def test_10_bows_and_waves_with_a_foot_on_a_block():
    assert_bows_and_waves(ran("10_block.py"), ("left_foot on block/top", "right_foot"))


@pytest.mark.slow
def test_11_bows_and_waves_on_a_slope():
    example = ran("11_slope.py")
    assert_bows_and_waves(example, ("left_foot on slope/top", "right_foot on slope/top"))
    tilts = [pose.rotation[2, 0] for pose in example["motion"].phases[0].feet.values()]
    np.testing.assert_allclose(tilts, np.sin(np.deg2rad(10.0)), atol=1e-6)


@pytest.mark.slow
def test_12_leans_a_hand_on_a_wall():
    example = ran("12_wall.py")
    done = example["done"]
    log = done.log.trimmed()
    assert done.fell_at_s is None
    pressed = (log.time > 3.5) & (log.time < 4.0)
    hand = log.contact_names.index("right_hand_end on wall/front")
    np.testing.assert_allclose(log.contact_normal[pressed, hand], 40.0, atol=1.5)
    np.testing.assert_allclose(log.contact_force[pressed, hand, 0], -40.0, atol=1.5)  # the wall pushes it back
    assert log.contact_normal[log.time > 4.6, hand].max() < 5.0
    assert np.abs(np.diff(log.torque, axis=0)).max() < 28.0


def test_13_carries_a_bag_and_bears_a_pull():
    example = ran("13_loads.py")
    sway, tick = np.array(example["sway"]), example["controller"].tick
    assert 0.003 < sway[200:500].max() < 0.05  # it does not know of the bag yet
    assert sway[-1] < 0.002 and sway[750:].max() < 0.05
    assert tick.mass == pytest.approx(example["robot"].mass + 8.0)


@pytest.mark.slow
def test_14_walks_up_a_slope_and_down_again():
    example = ran("14_slope_walk.py")
    done, motion, robot = example["done"], example["motion"], example["robot"]
    log = done.log.trimmed()
    assert done.fell_at_s is None and log.time[-1] > motion.duration - 0.01
    way, rise = log.com[:, 0] - log.com[0, 0], log.com[:, 2] - log.com[0, 2]
    assert way.max() > 0.98 and rise.max() > 0.98 * np.tan(np.deg2rad(10.0)) and abs(way[-1]) < 0.05
    assert np.abs(log.com - motion.com[: len(log.com)]).max() < 0.01
    assert np.abs(np.diff(log.torque, axis=0)).max() < 28.0
    assert all(np.ptp(point(example, foot)[:, 0]) > 0.98 for foot in robot.feet)


@pytest.mark.parametrize("package", sorted(PACKAGES))
def test_packages_say_that_they_carry_types(package):
    assert (FOLDER.parents[1] / package / "py.typed").is_file()


def test_15_turns_the_chest_on_soft_feet():
    example = ran("15_servo.py")
    log, yaw = example["done"].log.trimmed(), 7 + example["yaw"]
    assert example["done"].fell_at_s is None
    assert log.q[-1, yaw] == pytest.approx(0.2, abs=0.005)
    assert np.abs(log.sole_deflection).max() > 1e-4


@pytest.mark.slow
def test_a_hand_on_a_table_carries_what_the_foot_cannot():
    example = ran("hand_support.py")
    done, robot = example["done"], example["robot"]
    log = done.log.trimmed()
    assert done.fell_at_s is None
    rest = log.time > 12.0
    foot, left = point(example, "right_foot")[rest], point(example, "left_foot")[rest]
    beyond = log.com[rest, 0] - foot[:, 0] - robot.sole("right_foot")[:, 0].max()
    assert beyond.min() > 0.01 and left[:, 2].min() > 0.04
    palm = log.contact_normal[rest, log.contact_names.index("right_palm on table/top")]
    np.testing.assert_allclose(palm, palm.mean(), atol=2.0)
    weight = 9.81 * robot.mass
    assert palm.mean() + log.contact_normal[rest, log.contact_names.index("right_foot")].mean() == pytest.approx(
        weight, rel=0.01
    )
    assert np.abs(np.diff(log.torque, axis=0)).max() < 28.0
