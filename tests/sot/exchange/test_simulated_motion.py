"""The project's own file of a run."""

import json

import numpy as np
import pytest

from sot.errors import InputError
from sot.exchange.licence_card import UNKNOWN, licence_card
from sot.exchange.registry import FORMATS, read_motion
from sot.exchange.robot_motion import RobotMotion
from sot.exchange.simulated_motion import SimulatedMotion
from sot.robots.robot import Robot
from tests.sot.exchange.motions import swaying


def simulated() -> SimulatedMotion:
    motion = swaying()
    count, feet = motion.count, tuple(motion.robot.feet)
    assert motion.torque is not None and motion.contacts is not None
    return SimulatedMotion(
        q=motion.q,
        v=motion.v,
        a=np.zeros_like(motion.v),
        torque=motion.torque,
        contact=motion.contacts,
        wrench=np.ones((count, 2, 6)),
        zmp=np.zeros((count, 2)),
        zmp_margin=np.full(count, np.nan),
        friction_margin=np.ones((count, 2)),
        reference=motion.q,
        human=np.zeros((4, 1, 3)),
        human_rate=30.0,
        human_points=("head",),
        rate=motion.rate,
        joints=motion.robot.joints,
        feet=feet,
        facts={"clip": "sway", "robot": "hrp2"},
    )


def test_it_is_read_back_and_is_a_format(tmp_path):
    path, made = tmp_path / "simulated.npz", simulated()
    made.save(path)
    assert [file.name for file in tmp_path.iterdir()] == ["simulated.npz"]
    back = SimulatedMotion.load(path)
    assert np.array_equal(back.q, made.q) and back.facts == made.facts and back.joints == made.joints
    assert np.abs(back.torque - made.torque).max() < 1e-5 and np.isnan(back.zmp_margin).all()
    motion = read_motion(path, "sot-npz", swaying().robot)
    assert np.array_equal(motion.q, made.q) and motion.contacts is not None


def test_of_another_robot_version_or_shape(tmp_path):
    path = tmp_path / "simulated.npz"
    simulated().save(path)
    with pytest.raises(InputError, match="another robot"):
        SimulatedMotion.load(path).motion(Robot.load("g1"), "x")
    content = dict(np.load(path))
    for change in (
        {"facts": np.array(json.dumps({"version": 99}))},
        {"facts": np.array("no json")},
        {"q": content["q"][:, :-1]},
        {"rate": np.array(-1.0)},
        {"human": np.zeros((4, 2, 3))},
        {"human_rate": np.array("x")},
        {"torque": np.full_like(content["torque"], np.nan)},
    ):
        np.savez(path, **(content | change))
        with pytest.raises(InputError):
            SimulatedMotion.load(path)
    del content["wrench"]
    np.savez(path, **content)
    with pytest.raises(InputError, match="lacks wrench"):
        SimulatedMotion.load(path)


def test_other_rates_keep_times_and_contacts():
    motion = swaying(rate=100.0, frames=101)
    half = motion.resampled(50.0)
    assert (half.count, half.rate, half.duration) == (51, 50.0, 1.0)
    assert np.abs(half.q - motion.q[::2]).max() < 1e-12
    assert motion.contacts is not None and np.array_equal(half.contacts, motion.contacts[::2])
    third = motion.resampled(30.0)
    assert third.count == 31
    assert np.abs(third.q[3] - motion.q[10]).max() < 1e-12
    assert np.abs(np.linalg.norm(third.q[:, 3:7], axis=1) - 1.0).max() < 1e-12
    assert isinstance(motion.part(0.5, 0.2), RobotMotion) and motion.part(0.5, 0.2).count == 21


def test_velocities_are_the_configurations_derivatives():
    """The swaying motion is exp(way(t)) from rest: joints' speeds are way's own."""
    motion = swaying(rate=1000.0, frames=50)
    t, k = np.arange(50)[:, None] / 1000.0, np.arange(motion.robot.nv)
    w = 2.0 * np.pi * (0.3 + 0.02 * k)
    assert np.abs(motion.v[1:-1, 6:] - (0.1 * w * np.cos(w * t + k))[1:-1, 6:]).max() < 1e-4
    linear, _ = motion.root_velocity
    finite = 500.0 * (motion.q[2:, :3] - motion.q[:-2, :3])
    assert np.abs(linear[1:-1] - finite).max() < 1e-3


def test_the_card_says_whose_it_is_and_what_the_columns_are():
    motion = swaying()
    card = licence_card(motion, "gmr-pickle", FORMATS["gmr-pickle"].words, isaac=False)
    assert "CC0 1.0" in card and ", ".join(motion.robot.joints) in card and "26 at 50 per second" in card
    nobodys = RobotMotion(motion.robot, "x", 50.0, motion.q, motion.v)
    card = licence_card(nobodys, "tracking-npz-isaac", "", isaac=True)
    assert UNKNOWN in card and "breadth first" in card and ", ".join(motion.robot.joints) not in card
