"""A run as the project's own file of motions: what the robot did, with the margins that it had."""

import numpy as np

from sim.log import RunInfo, RunLog, nearest_frames
from sim.reporting.figures import zmp_margins
from sim.reporting.provenance import command_line, revision
from sot.exchange.simulated_motion import SimulatedMotion
from sot.gravity import GRAVITY
from sot.motion.performance import Performance
from sot.motion.trajectory import Motion

MIN_LOAD_SHARE = 0.01  # of the weight, on a foot that counts as on the floor


def simulated_motion(log: RunLog, info: RunInfo, motion: Motion, plan: Performance | None = None) -> SimulatedMotion:
    """What a run's robot did.

    Args:
        log: Rows of the run.
        info: Facts about the run.
        motion: The reference, whose contacts the ZMP is measured against.
        plan: How it came from a human, if it did.
    """
    log, robot = log.trimmed(), motion.robot
    normal, along = log.foot_wrench[:, :, 2], np.linalg.norm(log.foot_wrench[:, :, :2], axis=2)
    contact = normal > MIN_LOAD_SHARE * robot.mass * GRAVITY
    human = np.zeros((0, 0, 3)) if plan is None else np.stack(list(plan.human.points.values()), axis=1)
    ended = "upright" if info.fell_at_s is None else f"fell at {info.fell_at_s:.2f} s: {info.reason}"
    return SimulatedMotion(
        q=log.q,
        v=log.v,
        a=np.gradient(log.v, log.period, axis=0) if log.ticks > 1 else np.zeros_like(log.v),
        torque=log.torque,
        contact=contact,
        wrench=log.foot_wrench,
        zmp=log.zmp_measured,
        zmp_margin=zmp_margins(log, motion),
        friction_margin=np.where(contact, info.mismatch.friction * normal - along, np.nan),
        reference=motion.q[nearest_frames(log.time, motion.rate, len(motion.q))],
        human=human,
        human_rate=0.0 if plan is None else plan.human.rate,
        human_points=() if plan is None else tuple(plan.human.points),
        rate=1.0 / log.period if log.ticks > 1 else info.rate_hz,
        joints=robot.joints,
        feet=tuple(robot.feet),
        facts={
            "robot": info.robot,
            "label": robot.label,
            "clip": info.clip,
            "source": info.source,
            "licence": info.licence,
            "command": command_line(),
            "revision": revision(),
            "ended": ended,
        },
    )
