"""The simulated depth camera: what is hidden, and that a robot can follow what is left."""

import numpy as np
import pytest

from sot.live.follower import Follower
from sot.live.sensing.depth_camera import DepthCamera, hidden_joints
from sot.robots.robot import Robot
from tests.sot.live.people import groove


def test_a_joint_behind_a_bone_is_hidden():
    positions = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.6], [-0.4, 0.02, 1.3], [-0.4, 0.5, 1.3], [0.4, 0.0, 1.3]])
    hidden = hidden_joints(positions, (-1, 0, 1, 1, 1), np.array([3.0, 0.0, 1.3]))
    assert hidden.tolist() == [False, False, True, False, False]


@pytest.mark.parametrize("rate", [10.0, 30.0])
def test_pictures_come_at_its_rate_with_its_noise(rate):
    camera, source = DepthCamera(groove(60.0), rate, noise=0.02, dropouts=0.1, seed=3), groove(60.0)
    pictures, truth = camera.poll(0.0) + camera.poll(4.0), source.poll(0.0) + source.poll(4.0)
    assert len(pictures) == pytest.approx(4.0 * rate, abs=2)
    by_stamp = {round(frame.stamp, 6): frame for frame in truth}
    off = np.array([picture.positions - by_stamp[round(picture.stamp, 6)].positions for picture in pictures])
    assert np.median(np.abs(off)) == pytest.approx(0.6745 * 0.02, rel=0.2)
    assert all(picture.rotations is None for picture in pictures)
    assert camera.counts["dropouts"] > 0


def test_a_robot_follows_it():
    follower = Follower(DepthCamera(groove(60.0), noise=0.01, dropouts=0.05), Robot.load("hrp2"))
    for k in range(300):
        follower.update(0.01 * k)
    assert follower.counts["persons"] == 1
    assert len(follower.shown) > 40
