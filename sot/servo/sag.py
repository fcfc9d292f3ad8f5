"""The static deflection of compliant feet and of joint servos under the planned load, undone beforehand."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.hardware.compliance import FootCompliance
from sot.hardware.servo import Servo
from sot.motion.trajectory import MotionSample
from sot.robots.robot import Robot
from sot.rotation import cross
from sot.servo.load_sharing import FootLoad

Array = np.ndarray


def bush_compliance(compliance: FootCompliance) -> Array:
    """1 / K of roll, pitch [rad/(N m)] and height [m/N], shape (3,)."""
    return 1.0 / np.array([compliance.roll, compliance.pitch, compliance.vertical])


def sag_offset(load: FootLoad, compliance: Array, bush: Array) -> Array:
    """Roll, pitch and height (3,) that a foot is to be off by so that its load deflects it back to the plan [rad, m].

    The moment about the bush, M + (o − b) × F, turns the sole by M / K against the foot; as the sole lies flat, the
    foot turns by −M / K against the floor, and all of the robot with it. An upright pendulum multiplies that by
    K / (K − m g l). Turned by −M / K beforehand, the foot leaves the robot where it was meant to be.

    Args:
        load: planned, about the origin o of the foot frame.
        compliance: 1 / K, (3,), see `bush_compliance`.
        bush: its middle b (3,) in the foot frame [m].
    """
    x, y, _ = load.moment - cross(bush, load.force)
    return -compliance * np.array([x, y, load.force[2]])


class ServoSag:
    """Offsets of joint targets at which servos give the torques of the plan where the plan has the joints.

    A servo gives τ at an error τ / kp. The torques are those of the planned accelerations and of the loads of the feet.

    Args:
        robot: the robot.
        servo: of its joints.
    """

    def __init__(self, robot: Robot, servo: Servo) -> None:
        self._robot, self._data, self._stiffness = robot, robot.model.createData(), servo.stiffness

    def __call__(self, plan: MotionSample, loads: Mapping[str, FootLoad]) -> Array:
        """The offsets (na,) [rad].

        Args:
            plan: the planned state and its accelerations.
            loads: of the feet that stand.
        """
        model, data = self._robot.model, self._data
        force = pin.rnea(model, data, plan.q, plan.v, plan.a).copy()
        pin.computeJointJacobians(model, data, plan.q)
        for foot, load in loads.items():
            frame = self._robot.point(foot)
            pin.updateFramePlacement(model, data, frame)
            jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL)
            force -= jacobian.T @ np.concatenate([load.force, load.moment])
        offsets: Array = force[6:] / self._stiffness
        return offsets
