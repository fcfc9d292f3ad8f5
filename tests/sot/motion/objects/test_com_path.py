"""A human's centre of mass, and the robot's that is among its supports as the human's is among its own."""

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from sot.motion import read, recognise
from sot.motion.objects.com_path import com_path, human_support
from sot.motion.objects.human_mass import human_com

DATA = Path(str(files("scenarios.inputs"))) / "data"
FEET = {"left_foot": np.array([0.02, 0.1]), "right_foot": np.array([0.02, -0.1])}
SOLE = np.array([[0.1, 0.06], [-0.1, 0.06], [-0.1, -0.06], [0.1, -0.06]])
LEG = 0.6


@pytest.fixture(scope="module")
def human():
    return recognise(read(DATA / "box_stand.bvh"))


def test_a_standing_humans_centre_of_mass_is_above_its_hips_and_between_its_feet(human):
    com, waist = human_com(human)[0], human.points["waist"][0]
    assert waist[2] < com[2] < waist[2] + 0.2
    assert abs(com[1]) < 1e-3 and abs(com[0] - human_support(human, "left_foot")[0, 0]) < 0.15


def test_it_goes_over_the_foot_that_the_human_stands_on(human):
    corners = [SOLE + place for place in FEET.values()]
    path = com_path(human, 1.0, FEET, corners, 100.0, LEG)
    assert path(0.0)[0] == pytest.approx([0.02, 0.0], abs=1e-3)
    assert path(7.0)[0][1] > 0.07
    assert max(abs(place[1]) for place in path.position) < 0.16 - 0.03


def test_one_support_is_where_it_stays(human):
    path = com_path(human, 1.0, {"left_foot": FEET["left_foot"]}, [SOLE + FEET["left_foot"]], 100.0, LEG)
    assert np.abs(path.position - FEET["left_foot"]).max() < 1e-6


def test_velocity_and_acceleration_are_its_derivatives(human):
    path = com_path(human, 1.0, FEET, [SOLE + place for place in FEET.values()], 500.0, LEG)
    dt = 2e-3
    x, v, a = (np.array(rows) for rows in zip(*(path(t) for t in np.arange(5.0, 6.0, dt)), strict=True))
    assert np.abs((x[2:] - x[:-2]) / (2 * dt) - v[1:-1]).max() < 1e-3
    assert np.abs((v[2:] - v[:-2]) / (2 * dt) - a[1:-1]).max() < 0.05
