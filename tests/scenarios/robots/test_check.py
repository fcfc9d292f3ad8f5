"""Each fault that is planted in a robot file, or its model, is found, with what to do about it."""

import re
from pathlib import Path

import numpy as np
import pytest

from scenarios.robots.check import check
from scenarios.robots.findings import Severity, stopping
from scenarios.robots.standing import stances
from sot.robots.robot import MODELS, Robot

SOLE = '["left_sole_front_out", "left_sole_front_in", "left_sole_back_in", "left_sole_back_out"]'
LARGE = "[[0.2, 0.075, 0.0], [0.2, -0.056, 0.0], [-0.1, -0.056, 0.0], [-0.1, 0.075, 0.0]]"
SMALL = "[[0.05, 0.03, 0.0], [0.05, -0.03, 0.0], [-0.05, -0.03, 0.0], [-0.05, 0.03, 0.0]]"
BENT = "[rest]\nRLEG2 = -0.5\nRLEG3 = 1.0\nRLEG4 = -0.5\nLLEG2 = -0.5\nLLEG3 = 1.0\nLLEG4 = -0.5\n"
REST, POINTS = 'rest = "half_sitting"', r"\[points\]"


def faulty(folder: Path, changes: dict[str, str], model: dict[str, str]) -> Path:
    """A copy of the shipped robot's file and model with some text replaced."""
    for name, replaced in (("hrp2.toml", changes), ("hrp2.xml", model)):
        text = (MODELS / name).read_text()
        for old, new in replaced.items():
            assert re.search(old, text), old
            text = re.sub(old, new, text)
        (folder / name).write_text(text)
    return folder / "hrp2.toml"


FAULTS = {  # changes of the file, changes of the model, severity, what is found, where
    "sole too large": ({re.escape(SOLE): LARGE}, {}, Severity.WARNS, "beyond what its shapes touch", "left_foot"),
    "sole too small": ({re.escape(SOLE): SMALL}, {}, Severity.NOTES, "smaller than what touches", "soles.left_foot"),
    "sole not flat": (
        {re.escape(SOLE): LARGE.replace("-0.1, 0.075, 0.0", "-0.1, 0.075, 0.02")},
        {},
        Severity.STOPS,
        "not flat",
        "left_foot",
    ),
    "feet swapped": (
        {'left_knee = "left': 'left_knee = "right', 'right_knee = "right_knee"': 'right_knee = "left_knee"'},
        {},
        Severity.STOPS,
        "on the other side",
        "left_knee, right_knee",
    ),
    "groups swapped": (
        {"left_leg = ": "other_leg = ", "right_leg = ": "left_leg = ", "other_leg = ": "right_leg = "},
        {},
        Severity.STOPS,
        "do not move left_foot",
        "RLEG0",
    ),
    "weak hip": ({r"\Z": "\n[limits.effort]\nLLEG2 = 5\n"}, {}, Severity.WARNS, "little for 58 kg", "LLEG2 5 N m"),
    "weak knees": (
        {r"\Z": "\n[limits.effort]\nLLEG3 = 30\nRLEG3 = 30\n"},
        {},
        Severity.STOPS,
        "standing on both feet takes more effort",
        "LLEG3",
    ),
    "straight knees": ({REST: "", POINTS: "[rest]\n[points]"}, {}, Severity.STOPS, "straight at rest", "left knee"),
    "no group": ({', "HEAD1"\\]': "]"}, {}, Severity.WARNS, "no group", "HEAD1"),
    "spring": ({}, {'name="HEAD1" axis': 'name="HEAD1" stiffness="3" axis'}, Severity.WARNS, "springs", "HEAD1"),
    "coupling": (
        {},
        {"</worldbody>": '</worldbody><equality><joint joint1="HEAD0" joint2="HEAD1"/></equality>'},
        Severity.WARNS,
        "couplings",
        "HEAD0",
    ),
    "five joints a leg": (
        {
            REST: "locked = { LLEG5 = 0.0, RLEG5 = 0.0 }",
            ', "([LR])LEG5"\\]': "]",
            "[LR]LEG5 = 7.854\n": "",
            POINTS: BENT + "[points]",
        },
        {},
        Severity.STOPS,
        "has 5 joints: it cannot hold a flat foot",
        "left leg",
    ),
    "narrow ankles": (
        {r"\Z": "\n[limits.lower]\nLLEG5 = -0.02\n[limits.upper]\nLLEG5 = 0.02\n"},
        {},
        Severity.WARNS,
        "cannot be brought over the left foot",
        "LLEG5",
    ),
    "shank on the floor": (
        {},
        {'(name="LLEG3_LINK_0".*0.037) -0.23"': r'\1 -0.36"'},
        Severity.STOPS,
        "no foot",
        "LLEG3_LINK",
    ),
    "hand on thigh": (
        {REST: "", POINTS: BENT + "LARM1 = -0.1\nRARM1 = -0.17\n[points]"},
        {},
        Severity.WARNS,
        "touch at rest",
        "LARM",
    ),
    "nothing to load": ({"label = .*": ""}, {}, Severity.STOPS, "'label' is missing", "hrp2.toml"),
}


@pytest.mark.parametrize(("changes", "model", "severity", "what", "where"), FAULTS.values(), ids=FAULTS.keys())
def test_a_planted_fault_is_found(changes, model, severity, what, where, tmp_path):
    findings = check(faulty(tmp_path, changes, model))
    found = [each for each in findings if what in each.what and where in each.where + each.what]
    assert found, findings
    assert found[0].severity == severity
    assert found[0].remedy
    assert stopping(findings) == any(each.severity == Severity.STOPS for each in findings)


@pytest.mark.parametrize("name", ["hrp2", "hrp2_modified"])
def test_the_shipped_robots_have_no_fault(name):
    assert check(name) == []


def test_standing_torques_carry_the_robot_and_shift_with_it():
    robot = Robot.load("hrp2")
    both, left, right = stances(robot)
    assert left.reached and right.reached
    for stance in (both, left, right):
        assert np.abs(stance.torques).max() < robot.effort.max()
    roll = robot.joints.index("LLEG1")
    # One hip carries the body and the other leg, over the distance between hip and centre of mass.
    assert abs(left.torques[roll]) > 3.0 * abs(both.torques[roll])
    assert abs(right.torques[roll]) < abs(left.torques[roll])
