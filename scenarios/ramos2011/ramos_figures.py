"""The figures of the three dances of Ramos 2011, VI: what the geometric one cannot do, what the edits bring back."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from scenarios.ramos2011.ramos_edits import HAND, KneeOscillation, hand_height, oscillation_amplitude
from sim.log import RunLog
from sot.control.tick import Tick
from sot.motion.feet.contacts import Phase, phase_indices, support_polygon
from sot.motion.plan import PLAN_RATE
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

Array = NDArray[np.float64]

SAMPLED_RATE = 50.0
"""Rate at which postures are evaluated [Hz]."""


def geometric_figures(motion: Motion) -> dict[str, float]:
    """By how much a motion is none that a robot on the floor can do, by its inverse dynamics.

    Returns:
        "zmp_outside": share of the time in which the floor would have to push from outside the soles' support polygon;
        "zmp_outside_p95_m": 95th percentile of how far outside; "torque_max" and "velocity_max": largest joint torque
        and velocity over their limits, the feet sharing what the floor has to give by least squares.
    """
    robot, rows = motion.robot, np.arange(0, len(motion.q), max(1, round(motion.rate / SAMPLED_RATE)))
    margins = np.empty(len(rows))
    phases = phase_indices(motion.phases, rows / motion.rate)
    for index in np.unique(phases).tolist():
        here = phases == index
        margins[here] = support_polygon(robot, motion.phases[index]).margin(motion.zmp[rows[here]])
    tick = Tick(robot)
    torques = [required_torque(tick.update(0.0, motion.q[k], motion.v[k]), motion.a[k]) for k in rows.tolist()]
    return {
        "zmp_outside": float(np.mean(margins < 0.0)),
        "zmp_outside_p95_m": float(max(np.percentile(-margins, 95.0), 0.0)),
        "torque_max": float((np.abs(torques) / robot.effort).max()),
        "velocity_max": float((np.abs(motion.v[:, 6:]) / robot.velocity).max()),
    }


def required_torque(tick: Tick, acceleration: Array) -> Array:
    """Joint torques (na,) that a state and its acceleration (nv,) need, ``Sᵀ τ = M v̇ + h − Jᵀ φ``; the wrenches φ of
    both feet are the least that move the base [N m]."""
    forces = tick.M @ acceleration + tick.h
    J = np.vstack([tick.frame(foot).jacobian for foot in tick.robot.feet])
    wrenches = np.linalg.lstsq(J[:, :6].T, forces[:6], rcond=None)[0]
    return forces[6:] - J[:, 6:].T @ wrenches


def knee_figures(
    knees: Sequence[KneeOscillation], geometric: Motion, posture: RunLog, final: RunLog
) -> list[dict[str, Any]]:
    """Of each oscillation found: where, at which frequency, and its amplitude as demonstrated, with the posture task
    only, and with the task on the knee, Ramos Figure 6."""
    found = []
    for knee in knees:
        column = 7 + knee.joint
        shown = oscillation_amplitude(geometric.times, geometric.q[:, column], knee.oscillation)
        only, edited = (oscillation_amplitude(log.time, log.q[:, column], knee.oscillation) for log in (posture, final))
        found.append(
            {
                "knee": knee.point,
                "start_s": knee.oscillation.start,
                "end_s": knee.oscillation.end,
                "frequency_hz": knee.oscillation.frequency,
                "demonstrated_deg": float(np.rad2deg(shown)),
                "posture_deg": float(np.rad2deg(only)),
                "final_deg": float(np.rad2deg(edited)),
                "posture_share": only / shown,
                "final_share": edited / shown,
            }
        )
    return found


def hand_figures(
    robot: Robot, wanted: Array, spans: Sequence[tuple[float, float]], posture: RunLog, final: RunLog
) -> dict[str, Any]:
    """How far the right hand's height is from the dancer's (T,) while it is raised, Ramos Figure 7, and how near it
    comes to the head."""
    times = np.arange(len(wanted)) / PLAN_RATE
    raised = np.zeros(len(times), bool)
    for start, end in spans:
        raised |= (times >= start) & (times <= end)
    figures: dict[str, Any] = {"raised_s": [[round(t, 2) for t in span] for span in spans]}
    for name, log in (("posture", posture), ("final", final)):
        height = np.interp(times, *hand_height(log, robot))
        off = (height - wanted)[raised]
        figures[f"{name}_rms_m"] = float(np.sqrt(np.mean(off**2))) if raised.any() else None
        figures[f"{name}_head_min_m"] = min_hand_head_distance(robot, log)
    return figures


def slide_figures(slide: Mapping[str, Any], motion: Motion, posture: RunLog) -> dict[str, float]:
    """The share of the time of a slide in which the ZMP of the posture task alone lay in the other foot, Ramos
    Figure 8."""
    rows = (posture.time >= slide["start_s"]) & (posture.time < slide["end_s"])
    phase = motion.phases[int(phase_indices(motion.phases, np.array([slide["start_s"]]))[0])]
    others = {foot: pose for foot, pose in phase.feet.items() if foot != slide["foot"]}
    margin = support_polygon(motion.robot, Phase(phase.start, phase.end, others)).margin(posture.zmp_measured[rows])
    return {"posture_zmp_inside": float(np.mean(margin >= 0.0)) if rows.any() else 0.0}


def min_hand_head_distance(robot: Robot, log: RunLog) -> float:
    """Least distance between the right hand and the head during a run [m]."""
    shapes = robot.shapes.copy()
    shapes.removeAllCollisionPairs()
    hand = _shapes_of(robot, [robot.model.frames[robot.point(HAND)].parentJoint])
    head = _shapes_of(robot, [robot.model.getJointId(robot.joints[k]) for k in robot.groups["head"]])
    for first in hand:
        for second in head:
            shapes.addCollisionPair(pin.CollisionPair(first, second))
    data, measured = robot.model.createData(), shapes.createData()
    least = np.inf
    for k in log.rows_at(SAMPLED_RATE).tolist():
        pin.updateGeometryPlacements(robot.model, data, shapes, measured, log.q[k])
        for pair in range(len(shapes.collisionPairs)):
            least = min(least, pin.computeDistance(shapes, measured, pair).min_distance)
    return float(least)


def _shapes_of(robot: Robot, joints: Sequence[int]) -> list[int]:
    """Shapes on some joints; those of the first joint above that has any, if they have none."""
    found = [k for k, shape in enumerate(robot.shapes.geometryObjects) if shape.parentJoint in joints]
    return found or _shapes_of(robot, [robot.model.parents[joints[0]]])
