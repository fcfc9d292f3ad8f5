"""How a box is taken from the floor."""

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.carrying.fetch import STOOP_PITCH, _Lifting, box_ahead
from sot.robots.robot import Robot


def test_the_box_goes_straight_up_while_the_trunk_does(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Robot.load("hrp2")
    monkeypatch.setattr("sot.motion.carrying.fetch.LIFTING_POSTURES", 5)
    size = (0.17, 0.34, 0.6)
    lifting = _Lifting(robot, size, 0.25)
    angles, lowered, pitch, before = lifting.at(np.array([0.0, 1.0]))
    assert pitch == pytest.approx([STOOP_PITCH, 0.0]) and lowered[0] > 0.05 and lowered[1] == pytest.approx(0.0)
    assert np.abs(angles[0] - angles[1]).max() > 0.2
    data = robot.model.createData()
    q = robot.rest.copy()
    q[7 + robot.joint_numbers("arms")] = angles[1]
    pin.framesForwardKinematics(robot.model, data, q)
    chest = data.oMf[robot.point("chest")]
    box = chest.act(before[1])  # the arms' weight moves the waist a little
    np.testing.assert_allclose(box[:2], [box_ahead(robot), 0.0], atol=0.06)
    palms = [
        data.oMf[robot.point(f"{side}_hand")].act(robot.surface(f"{side}_palm").placement.translation)
        for side in ("left", "right")
    ]
    np.testing.assert_allclose(np.mean(palms, axis=0) - box, [0.0, 0.0, 0.25], atol=1e-5)
    assert palms[0][1] - palms[1][1] == pytest.approx(size[1], abs=1e-5)
