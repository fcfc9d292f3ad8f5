"""The figures of a run on joint servos."""

import numpy as np
import pinocchio as pin

from sim.log import RunInfo, RunLog
from sim.reporting.figures import MOST_NAMED, Figures
from sot.hardware.readings import measured_zmp
from sot.robots.robot import Robot

SENSED_ZMP_RATE_HZ = 100.0
"""Rate at which the ZMP of the force sensors is compared."""


SERVO_KEYS = (
    *("error_rms_rad", "error_max_rad", "worst_joints"),
    *("sole_deflection_max_rad", "sole_sink_max_m", "sensed_zmp_rms_m"),
)


def servo_figures(log: RunLog, info: RunInfo, robot: Robot) -> dict[str, object]:
    """How well servos followed their targets, and what soles and force sensors did; all None for torque motors.

    - "error_rms_rad", "error_max_rad": joint angles off what their servos were told, over all joints.
    - "worst_joints": the greatest error of the joints with the greatest [rad].
    - "sole_deflection_max_rad", "sole_sink_max_m": of compliant feet while they carry, else None.
    - "sensed_zmp_rms_m": ZMP by the feet's force sensors, Kim & Oh (29), (30), off the floor's own.
    """
    if info.hardware.servo is None:
        return dict.fromkeys(SERVO_KEYS)
    error = np.abs(log.q[:, 7:] - log.target)
    greatest = error.max(axis=0, initial=0.0)
    worst = np.argsort(-greatest, kind="stable")[:MOST_NAMED]
    return {
        "error_rms_rad": float(np.sqrt(np.mean(error**2))) if error.size else None,
        "error_max_rad": float(greatest.max(initial=0.0)),
        "worst_joints": {robot.joints[k]: float(greatest[k]) for k in worst},
        **_sole_figures(log),
        "sensed_zmp_rms_m": _sensed_zmp_error(log, robot),
    }


def _sole_figures(log: RunLog) -> Figures:
    carrying = log.sole_deflection[log.foot_wrench[:, : log.sole_deflection.shape[1], 2] > 0.0]
    if not len(carrying):
        return {"sole_deflection_max_rad": None, "sole_sink_max_m": None}
    return {
        "sole_deflection_max_rad": float(np.linalg.norm(carrying[:, :2], axis=1).max()),
        "sole_sink_max_m": float(np.abs(carrying[:, 2]).max()),
    }


def _sensed_zmp_error(log: RunLog, robot: Robot) -> float | None:
    """Distance of the ZMP of the force sensors from that of the floor's forces, rms [m]."""
    if not log.foot_reading.shape[1]:
        return None
    data, off = robot.model.createData(), []
    for row in log.rows_at(SENSED_ZMP_RATE_HZ):
        pin.forwardKinematics(robot.model, data, log.q[row])
        feet = {foot: pin.updateFramePlacement(robot.model, data, robot.point(foot)) for foot in robot.feet}
        sensed = measured_zmp(dict(zip(robot.feet, log.foot_reading[row], strict=True)), feet)
        off.append(np.linalg.norm(sensed - log.zmp_measured[row]))
    known = np.array(off)[np.isfinite(off)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else None
