"""The figures that others publish of motions, on motions whose flaws are known."""

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.quality import KEYS, WEIGHTS, key_body_errors, motion_quality
from sot.robots.robot import Robot

RATE, FRAMES = 50.0, 100


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def still(robot: Robot) -> np.ndarray:
    return np.tile(robot.rest, (FRAMES, 1))


def test_who_stands_still_has_no_flaw(robot):
    found = motion_quality(robot, still(robot), RATE)
    assert set(found) == set(KEYS)
    assert found["limmt_score"] == 100.0
    assert all(found[name] == 0.0 for name in (*WEIGHTS, "foot_speed_m_s", "jerk_rad_s3", "self_penetration_max_m"))
    assert found["penetration_max_m"] < 1e-6


def test_feet_that_slide(robot):
    q = still(robot)
    q[:, 0] += 0.2 * np.arange(FRAMES) / RATE
    found = motion_quality(robot, q, RATE)
    assert found["foot_sliding"] == 1.0 and abs(found["foot_speed_m_s"] - 0.2) < 1e-9
    assert abs(found["limmt_score"] - (100.0 - 1.70)) < 1e-9


def test_feet_in_the_floor_and_in_the_air(robot):
    q = still(robot)
    q[: FRAMES // 4, 2] -= 0.02
    found = motion_quality(robot, q, RATE)
    assert found["penetration"] == 0.25 and abs(found["penetration_max_m"] - 0.02) < 1e-6
    assert abs(found["limmt_score"] - (100.0 - 216.62 * 0.25)) < 1e-9
    q = still(robot)
    q[:60, 2] += 0.2  # for 1.2 s
    q[70:100, 2] += 0.2  # for 0.6 s, which is allowed
    assert motion_quality(robot, q, RATE)["airborne"] == 0.6


def test_joints_too_fast_and_bodies_in_one_another(robot):
    q = still(robot)
    joint = 7 + robot.joints.index(robot.joints[robot.groups["left_arm"][0]])
    q[50:, joint] += 2.0 * robot.velocity[joint - 7] / RATE
    found = motion_quality(robot, q, RATE)
    assert abs(found["joint_speed"] - 1.0 / (FRAMES - 1)) < 1e-9
    q = still(robot)
    for name in robot.groups["left_arm"]:
        q[:, 7 + name] = 0.0
    shoulder_roll = 7 + robot.groups["left_arm"][1]
    depths = []
    for angle in (-1.0, 1.0):  # one of them goes through the trunk
        q[:, shoulder_roll] = angle
        depths.append(motion_quality(robot, q[:8], RATE)["self_penetration_max_m"])
    assert max(depths) > 0.01


def test_jerk_of_a_cubic(robot):
    q, t = still(robot), np.arange(FRAMES) / RATE
    q[:, 7:] = (0.1 * t**3)[:, None]
    assert abs(motion_quality(robot, q, RATE)["jerk_rad_s3"] - 0.6) < 1e-6


def test_a_faster_recording_gives_the_same(robot):
    q = still(robot)
    q[:, 0] += 0.2 * np.arange(FRAMES) / RATE
    dense = np.repeat(q, 1, axis=0)
    t = np.arange(20 * FRAMES - 19) / (20.0 * RATE)
    dense = np.tile(robot.rest, (len(t), 1))
    dense[:, 0] += 0.2 * t
    assert abs(motion_quality(robot, dense, 20.0 * RATE)["foot_speed_m_s"] - 0.2) < 1e-9


def test_too_short_a_motion(robot):
    assert motion_quality(robot, still(robot)[:3], RATE) == dict.fromkeys(KEYS)


def test_key_bodies_in_the_world_and_relative(robot):
    wanted = still(robot)
    assert np.allclose(key_body_errors(robot, wanted, wanted), 0.0)
    place = pin.SE3(pin.utils.rotate("z", 0.7), np.array([0.3, -0.2, 0.0]))
    turned = wanted.copy()
    turned[:, :7] = pin.SE3ToXYZQUAT(place * pin.XYZQUATToSE3(wanted[0, :7]))
    world, relative = key_body_errors(robot, wanted, turned)
    assert world > 0.3 and relative < 1e-9
    raised = wanted.copy()
    raised[:, 2] += 0.05  # height is not aligned, as mjlab has it
    assert np.allclose(key_body_errors(robot, wanted, raised), (0.05, 0.05))
