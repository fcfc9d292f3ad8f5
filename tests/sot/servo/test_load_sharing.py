"""Loads of the feet against the force and zero-moment point that they are to add up to."""

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.feet.contacts import Phase
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.load_sharing import ContactLoadSharing, LoadSharing

FORCE = np.array([12.0, -7.0, 560.0])


def standing(phases=None):
    motion = Motion.standing(Robot.load("hrp2"), 4.0, 100.0)
    if phases:
        fields = {name: getattr(motion, name) for name in motion.__dataclass_fields__ if name[0] != "_"}
        motion = Motion(**{**fields, "phases": tuple(phases)})
    return motion


def stepping():
    feet = dict(standing().phases[0].feet)
    left = {"left_foot": feet["left_foot"]}
    return standing([Phase(0.0, 1.0, feet), Phase(1.0, 2.0, left), Phase(2.0, 4.0, feet)])


def zmp_of(loads, feet):
    """Zero-moment point (2,) and force (3,) of loads."""
    force, moment = np.zeros(3), np.zeros(3)
    for foot, load in loads.items():
        own = feet[foot].rotation @ load.force
        force += own
        moment += feet[foot].rotation @ load.moment + np.cross(feet[foot].translation, own)
    return np.array([-moment[1], moment[0]]) / force[2], force


@pytest.mark.parametrize("turn", [0.0, 0.7])
@pytest.mark.parametrize("where", [0.0, 0.3, 0.8, 1.0])
def test_loads_add_up_to_force_and_zero_moment_point(where, turn):
    feet = {
        foot: pin.SE3(pin.exp3(np.array([0.0, 0.0, turn])), np.zeros(3)) * pose
        for foot, pose in standing().phases[0].feet.items()
    }
    sharing = LoadSharing(standing([Phase(0.0, 4.0, feet)]))
    left, right = (feet[foot].act(sharing.middles[foot])[:2] for foot in feet)
    zmp = where * left + (1.0 - where) * right + 0.01 * np.array([np.cos(turn), np.sin(turn)])
    at, force = zmp_of(sharing(1.0, zmp, FORCE), feet)
    np.testing.assert_allclose(at, zmp, atol=1e-9)
    np.testing.assert_allclose(force, FORCE, atol=1e-9)


def test_a_foot_whose_heel_rises_bears_on_its_toes():
    """The two of them still add up, and it does not tell where the robot is."""
    feet = standing().phases[0].feet
    sharing = LoadSharing(standing([Phase(0.0, 1.0, feet), Phase(1.0, 4.0, feet, rising=("left_foot",))]))
    sole = standing().robot.sole("left_foot")
    toes, length = sole[:, 0].max(), np.ptp(sole[:, 0])
    middle = sum(feet[foot].act(sharing.middles[foot])[:2] for foot in feet) / 2.0
    flat, rising = sharing(0.5, middle, FORCE), sharing(2.0, middle, FORCE)
    for loads in (flat, rising):
        at, _ = zmp_of(loads, feet)
        np.testing.assert_allclose(at, middle, atol=1e-9)
    pressure = {
        name: -loads["left_foot"].moment[1] / loads["left_foot"].force[2]
        for name, loads in (("flat", flat), ("rising", rising))
    }
    assert pressure["flat"] < toes - 0.3 * length
    assert toes - 0.1 * length < pressure["rising"] < toes
    assert set(sharing.flat_feet(0.5)) == set(feet)
    assert set(sharing.flat_feet(2.0)) == {"right_foot"}


def test_centres_of_pressure_stay_on_the_soles():
    motion = standing()
    sharing, robot = LoadSharing(motion), motion.robot
    for zmp in ([0.5, 0.0], [-0.5, 0.4], [0.0, -0.9]):
        for foot, load in sharing(1.0, np.array(zmp), FORCE).items():
            if load.force[2] > 1e-9:
                x, y = -load.moment[1] / load.force[2], load.moment[0] / load.force[2]
                low, high = robot.sole(foot).min(axis=0), robot.sole(foot).max(axis=0)
                assert low[0] < x < high[0] and low[1] < y < high[1]


def test_a_foot_gives_its_load_away_before_it_leaves_and_takes_it_after_it_has_come():
    motion = stepping()
    sharing = LoadSharing(motion)
    middle = motion.com[0, :2]
    share = [sharing(t, middle, FORCE).get("right_foot") for t in np.arange(0.0, 4.0, 0.005)]
    load = np.array([0.0 if one is None else one.force[2] / FORCE[2] for one in share])
    assert load[0] == pytest.approx(0.5, abs=0.05) and load[-1] == pytest.approx(0.5, abs=0.05)
    assert np.abs(np.diff(load)).max() < 0.08  # nothing jumps
    assert load[int(1.5 / 0.005)] == 0.0
    assert sharing(1.5, middle, FORCE)["left_foot"].force[2] == pytest.approx(FORCE[2])


def test_shares_follow_contacts_wherever_steps_have_led_them():
    motion = standing()
    ahead = pin.SE3(np.eye(3), np.array([0.2, 0.0, 0.0]))
    planned = motion.phases[0].feet
    contacts = {"left_foot": (ahead * planned["left_foot"], 0.0), "right_foot": (planned["right_foot"], 1.0)}
    sharing = ContactLoadSharing(motion, lambda: contacts)
    assert sharing.limits(1.0) == {"left_foot": 0.0, "right_foot": 1.0}
    assert sharing(1.0, ahead.translation[:2], FORCE)["left_foot"].force == pytest.approx(np.zeros(3))
    contacts["left_foot"] = (ahead * planned["left_foot"], 1.0)
    feet = sharing.feet(2.0)
    middle = np.mean([place.act(sharing.middles[foot])[:2] for foot, place in feet.items()], axis=0)
    zmp, force = zmp_of(sharing(2.0, middle, FORCE), feet)
    np.testing.assert_allclose(zmp, middle, atol=1e-9)
    np.testing.assert_allclose(force, FORCE, atol=1e-9)
    del contacts["left_foot"]
    assert list(sharing(3.0, middle, FORCE)) == ["right_foot"]
