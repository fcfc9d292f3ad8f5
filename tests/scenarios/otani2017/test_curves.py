"""Figures 5, 7 and 8 of a run in numbers and pictures, from curves made by hand."""

from xml.etree import ElementTree

import numpy as np
import pytest

from scenarios.otani2017.curves import CURVES_FILE, leg_figures, load_curves, pitch_joint, save_curves
from scenarios.otani2017.pictures import draw
from sot.errors import InputError
from sot.motion.objects.events import ContactSets, SurfaceName, SurfacePair, contact_sets
from sot.robots import Robot


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def sets(*contacts: str) -> ContactSets:
    pairs = [SurfacePair.of(*map(SurfaceName.parse, contact.split())) for contact in contacts]
    return contact_sets(pairs, ())


LEFT, RIGHT = "robot/left_foot world/floor", "robot/right_foot world/floor"
HELD, PLACED = "robot/left_palm box/left", "box/bottom world/table"


def curves_like(robot, **more):
    """Ten seconds in which every curve grows with the time: torque of joint k is k t."""
    time = np.arange(0.0, 10.0, 0.02)
    torque = time[:, None] * np.arange(robot.na)
    return {
        "label": np.array("3 kg"),
        "robot": np.array(robot.name),
        "time": time,
        "clock": 0.5 * time,
        "torque": torque,
        "right_foot_back": 0.01 * time,
        "hand_force": 2.0 * time,
        **more,
    }


def test_what_is_carried_over_one_leg_is_averaged_until_it_is_set_down(robot):
    history = [
        (0.0, sets(LEFT, RIGHT)),
        (2.0, sets(LEFT, RIGHT, HELD)),
        (4.0, sets(LEFT, HELD)),
        (6.0, sets(LEFT, HELD, PLACED)),
        (8.0, sets(LEFT, PLACED)),
    ]
    legs = leg_figures(curves_like(robot), robot, history)
    assert legs["over_one_leg"] and (legs["start_s"], legs["end_s"]) == (4.0, 6.0)
    assert legs["left_hip_torque_mean_nm"] == pytest.approx(5.0 * pitch_joint(robot, "left", "hip"))
    assert legs["left_knee_torque_mean_nm"] == pytest.approx(5.0 * pitch_joint(robot, "left", "knee"))
    assert legs["right_foot_back_max_m"] == pytest.approx(0.06)
    assert legs["hand_force_mean_n"] == pytest.approx(10.0)


def test_where_both_feet_stand_it_is_the_last_second(robot):
    history = [(0.0, sets(LEFT, RIGHT)), (3.0, sets(LEFT, RIGHT, "robot/right_hand_end door/front"))]
    legs = leg_figures(curves_like(robot), robot, history)
    assert not legs["over_one_leg"] and legs["end_s"] - legs["start_s"] == pytest.approx(1.0)
    assert legs["right_ankle_torque_mean_nm"] == pytest.approx(9.48 * pitch_joint(robot, "right", "ankle"))


def test_pitch_joints_are_named_from_the_hip_down(robot):
    names = [robot.joints[pitch_joint(robot, "left", part)] for part in ("hip", "knee", "ankle")]
    assert names == ["LLEG2", "LLEG3", "LLEG4"]


def test_curves_come_back_from_their_file_and_a_folder_without_is_refused(robot, tmp_path):
    curves = curves_like(robot)
    save_curves(tmp_path / CURVES_FILE, curves)
    again = load_curves(tmp_path)
    assert again.keys() == curves.keys() and str(again["label"]) == "3 kg"
    np.testing.assert_array_equal(again["torque"], curves["torque"])
    with pytest.raises(InputError, match=r"holds no curves\.npz"):
        load_curves(tmp_path / "nothing")


@pytest.mark.parametrize("hinged", [False, True])
def test_pictures_have_a_panel_a_figure_and_a_curve_a_run(robot, tmp_path, hinged):
    more = {"angle": np.linspace(0.0, 25.0, 500)} if hinged else {}
    runs = [curves_like(robot, **more), curves_like(robot, label=np.array("8 kg"), **more)]
    draw(tmp_path / "two.svg", runs, "two runs")
    text = " ".join(ElementTree.parse(tmp_path / "two.svg").getroot().itertext())
    wanted = ("5: right ankle", "hinge") if hinged else ("7: free foot", "8: left hip", "8: left knee")
    assert all(title in text for title in wanted)
    assert ("5: right ankle" in text) == hinged
    assert "3 kg" in text and "8 kg" in text
