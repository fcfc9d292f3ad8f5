"""A G1 motion of another retargeter, spoiled by hand, is made feasible and danced."""

import json
from pathlib import Path

import numpy as np
import pytest

from scenarios import cli
from scenarios.replay import REPORT_FILE
from sot.robots.robot import Robot

MOTION = "motions/g1_29dof/whole_body_tracking/sub3_largebox_003_mj.npz"
SECONDS = 3.0


def write_spoiled(path: Path) -> None:
    """The motion as Unitree's CSV, by this script alone: sunk by 2 cm, feet that slide, an arm through the trunk."""
    file = np.load(Robot.load("g1").path.parents[2] / MOTION, allow_pickle=False)
    rate, names = float(file["fps"][0]), [str(name) for name in file["joint_names"]]
    q = file["joint_pos"][: round(SECONDS * rate)].astype(float)
    t = np.arange(len(q)) / rate
    q[:, 2] -= 0.02
    q[:, 0] += 0.15 * np.sin(0.5 * np.pi * t)
    share = np.exp(-(((t - t.mean()) / 0.5) ** 2))
    for joint, angle in (("shoulder_roll", 0.35), ("shoulder_yaw", -0.6), ("elbow", 0.3), ("shoulder_pitch", 0.2)):
        k = 7 + names.index(f"right_{joint}_joint")
        q[:, k] = (1.0 - share) * q[:, k] + share * angle
    np.savetxt(path, np.hstack([q[:, :3], q[:, [4, 5, 6, 3]], q[:, 7:]]), delimiter=",", fmt="%.8f")


@pytest.mark.slow
def test_a_spoiled_motion_is_made_feasible_and_danced(tmp_path):
    path, out = tmp_path / "spoiled.csv", tmp_path / "clean"
    write_spoiled(path)
    arguments = ["--from", "unitree-csv", "--fps", "50", "--robot", "g1", "--rate", "500", "--out", str(out)]
    assert cli.main(["replay", str(path), *arguments]) == cli.DONE  # upright
    report = json.loads((out / REPORT_FILE).read_text())
    before, after = report["incoming"], report["quality"]
    assert before["limmt_score"] < 10.0 and after["limmt_score"] > 95.0
    assert before["penetration_max_m"] > 0.02 and after["penetration_max_m"] < 0.002
    assert before["self_collision"] > 0.2 and after["self_collision"] == 0.0 == after["self_penetration_max_m"]
    assert report["limits"]["self_collision_min_m"] > 0.0 and report["contacts"]["slip_max_m"] < 0.005
