"""Breadth first, as Isaac Lab numbers bodies and joints; depth first, as MuJoCo does."""

import mujoco
import numpy as np

from sot.exchange.body_orders import breadth_first_joints, breadth_first_links
from sot.exchange.robot_motion import link_names
from sot.robots.robot import Robot
from tests.sot.exchange.motions import swaying


def test_links_are_in_mujocos_order_and_place():
    motion = swaying()
    model = motion.robot.mujoco_spec().compile()
    assert [model.body(k).name for k in range(1, model.nbody)] == list(link_names(motion.robot))
    data = mujoco.MjData(model)
    data.qpos[:] = np.hstack([motion.root_position, motion.root_wxyz, motion.angles])[4]
    mujoco.mj_forward(model, data)
    assert np.abs(data.xpos[1:] - motion.links.position[4]).max() < 1e-9


def test_isaacs_order_of_the_g1():
    """The first joints of Isaac Lab's G1: both hips and the waist, level by level."""
    robot = Robot.load("g1")
    names = [robot.joints[k].removesuffix("_joint") for k in breadth_first_joints(robot)]
    assert names[:11] == [
        *("left_hip_pitch", "right_hip_pitch", "waist_yaw", "left_hip_roll", "right_hip_roll", "waist_roll"),
        *("left_hip_yaw", "right_hip_yaw", "waist_pitch", "left_knee", "right_knee"),
    ]
    assert names[11:17] == [
        *("left_shoulder_pitch", "right_shoulder_pitch", "left_ankle_pitch", "right_ankle_pitch"),
        *("left_shoulder_roll", "right_shoulder_roll"),
    ]
    links = [link_names(robot)[k] for k in breadth_first_links(robot)]
    assert links[:4] == ["pelvis", "left_hip_pitch_link", "right_hip_pitch_link", "waist_yaw_link"]
    assert sorted(links) == sorted(link_names(robot))
