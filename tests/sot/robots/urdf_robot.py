"""The HRP-2-like robot as a URDF and a hand-written robot file: a second robot that differs only in its files."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from sot.robots.models import hrp2
from sot.robots.models.mjcf import AXES, Link, number_text

ROBOT_FILE = """
label = "A robot from a URDF"
model = "robot.urdf"

[rest]
RLEG2 = -0.453786
RLEG3 = 0.872665
RLEG4 = -0.418879
LLEG2 = -0.453786
LLEG3 = 0.872665
LLEG4 = -0.418879

[points]
waist = "BODY"
chest = "CHEST1_LINK"
neck = "HEAD0_LINK"
head = "HEAD1_LINK"
head_top = { frame = "HEAD1_LINK", position = [0, 0, 0.19] }
left_hip = "LLEG0_LINK"
left_knee = "LLEG3_LINK"
left_ankle = "LLEG5_LINK"
left_foot = { frame = "LLEG5_LINK", position = [0, 0, -0.105] }
left_shoulder = "LARM0_LINK"
left_elbow = "LARM3_LINK"
left_wrist = "LARM4_LINK"
left_hand = { frame = "LARM5_LINK", position = [0, 0, -0.10] }
right_hip = "RLEG0_LINK"
right_knee = "RLEG3_LINK"
right_ankle = "RLEG5_LINK"
right_foot = { frame = "RLEG5_LINK", position = [0, 0, -0.105] }
right_shoulder = "RARM0_LINK"
right_elbow = "RARM3_LINK"
right_wrist = "RARM4_LINK"
right_hand = { frame = "RARM5_LINK", position = [0, 0, -0.10] }

[soles]
left_foot = [[0.13, 0.075, 0], [0.13, -0.056, 0], [-0.1, -0.056, 0], [-0.1, 0.075, 0]]
right_foot = [[0.13, -0.075, 0], [0.13, 0.056, 0], [-0.1, 0.056, 0], [-0.1, -0.075, 0]]

[groups]
left_leg = ["LLEG0", "LLEG1", "LLEG2", "LLEG3", "LLEG4", "LLEG5"]
right_leg = ["RLEG0", "RLEG1", "RLEG2", "RLEG3", "RLEG4", "RLEG5"]
chest = ["CHEST0", "CHEST1"]
head = ["HEAD0", "HEAD1"]
left_arm = ["LARM0", "LARM1", "LARM2", "LARM3", "LARM4", "LARM5", "LARM6"]
right_arm = ["RARM0", "RARM1", "RARM2", "RARM3", "RARM4", "RARM5", "RARM6"]

[limits]
acceleration = 60
acceleration_hard = 400
"""


def write(folder: Path, robot_file: str = ROBOT_FILE) -> Path:
    """Write model and robot file into a folder; returns the robot file."""
    root = ET.Element("robot", name="robot")
    for link in hrp2.links():
        _add(root, link)
    (folder / "robot.urdf").write_text(ET.tostring(root, encoding="unicode"))
    path = folder / "robot.toml"
    path.write_text(robot_file)
    return path


def _add(root: ET.Element, link: Link) -> None:
    element = ET.SubElement(root, "link", name=link.name)
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=number_text(link.body.com))
    ET.SubElement(inertial, "mass", value=number_text(link.body.mass))
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    values = link.body.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    ET.SubElement(inertial, "inertia", {name: number_text(value) for name, value in zip(names, values, strict=True)})
    if link.name[1:5] == "LEG5":
        sole = link.collision[0]
        collision = ET.SubElement(element, "collision")
        ET.SubElement(collision, "origin", xyz=number_text(sole.at))
        ET.SubElement(ET.SubElement(collision, "geometry"), "box", size=number_text(2 * np.array(sole.size)))
    if link.joint and link.parent:
        j = link.joint
        damping, friction = hrp2.LOSSES[j.losses]
        joint = ET.SubElement(root, "joint", name=j.name, type="revolute")
        ET.SubElement(joint, "parent", link=link.parent)
        ET.SubElement(joint, "child", link=link.name)
        ET.SubElement(joint, "origin", xyz=number_text(link.offset))
        ET.SubElement(joint, "axis", xyz=AXES[j.axis])
        limits = {"lower": j.lower, "upper": j.upper, "effort": j.torque, "velocity": hrp2.MOTOR_SPEED / j.gear_ratio}
        ET.SubElement(joint, "limit", {name: number_text(value) for name, value in limits.items()})
        ET.SubElement(joint, "dynamics", damping=number_text(damping), friction=number_text(friction))
