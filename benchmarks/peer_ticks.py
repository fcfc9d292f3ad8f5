"""Ticks of a dance for another controller to solve, and our own controller's time for them.

    python benchmarks/peer_ticks.py ticks.npz [--seconds 4] > ours.json

Dances groove under physics and writes the robot (inertias, placements, soles, limits), the simulated states and the
references at every control tick as plain arrays: a peer may need another version of Pinocchio. Then the controller
solves the ticks again, in a tight loop as the peer does, which is faster than between physics and log. `sot bench
--peer` takes what this prints.
"""

import argparse
import json
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pinocchio as pin
from threadpoolctl import threadpool_limits

from scenarios.bench import phase_statistics
from scenarios.replay import Replay, dance
from scenarios.stacks import planted_stack
from sim.log import RunLog
from sim.reference import Reference
from solvers import Cascade
from sot.control.controller import Controller
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

POINT_NAMES = ("waist", "left_foot", "right_foot")
TICKS_PER_REFERENCE = 20  # ticks, between two runs of the reference computation


def robot_arrays(robot: Robot, q: np.ndarray) -> dict[str, Any]:
    """The robot as arrays, joint by joint after the free base, and its mass matrix at a configuration (nq,)."""
    model = robot.model
    data = model.createData()
    frames = [model.frames[robot.point(name)] for name in POINT_NAMES]
    inertias = list(model.inertias)[1:]
    axes = [_joint_axis(model, joint) for joint in range(2, model.njoints)]
    return {
        "names": np.array(list(model.names)[2:]),
        "parents": np.array(list(model.parents)[2:]),
        "axes": np.array(axes),
        "placements": np.array([placement.homogeneous for placement in list(model.jointPlacements)[1:]]),
        "masses": np.array([inertia.mass for inertia in inertias]),
        "levers": np.array([inertia.lever for inertia in inertias]),
        "inertias": np.array([inertia.inertia for inertia in inertias]),
        "armature": np.array(model.armature),
        "point_joints": np.array([frame.parentJoint for frame in frames]),
        "point_placements": np.array([frame.placement.homogeneous for frame in frames]),
        "lower": robot.lower,
        "upper": robot.upper,
        "velocity": robot.velocity,
        "acceleration": robot.acceleration_hard,
        "effort": robot.effort,
        "mass_matrix": np.array(pin.crba(model, data, q)),
    }


def _joint_axis(model: pin.Model, joint: int) -> np.ndarray:
    """Axis (3,) of a revolute joint in its own frame."""
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    column = model.joints[joint].idx_v
    return data.oMi[joint].rotation.T @ data.J[3:, column]


def tick_arrays(motion: Motion, log: RunLog) -> dict[str, Any]:
    """States of a run, and the references of the planted stack at these times."""
    rows = np.round(log.time * motion.rate).astype(int)
    waist = motion.track("waist")
    return {
        "period": log.period,
        "q": log.q,
        "v": log.v,
        "com": np.stack([motion.com, motion.com_velocity, motion.com_acceleration])[:, rows],
        "waist_rotation": waist.rotation[rows],
        "waist_motion": np.stack([waist.velocity, waist.acceleration])[:, rows],
        "joints": np.stack([motion.q[:, 7:], motion.v[:, 6:], motion.a[:, 6:]])[:, rows],
    }


def own_figures(motion: Motion, log: RunLog) -> dict[str, Any]:
    """Time of a tick of our controller on the states of a run."""
    controller = Controller(motion.robot, planted_stack(motion.robot, motion), Cascade(), log.period)
    again, reference = RunLog.allocate(motion.robot, log.ticks), Reference()
    with threadpool_limits(1):
        for k in range(log.ticks):
            start = perf_counter()
            command = controller(float(log.time[k]), log.q[k], log.v[k])
            again.tick_us[k] = 1e6 * (perf_counter() - start)
            again.model_us[k], again.assemble_us[k] = command.model_us, command.assemble_us
            again.solve_us[k] = command.solve_us
            if k % TICKS_PER_REFERENCE == 0:
                reference()
    name = "this controller, in a tight loop"
    return {"name": name, "ticks": log.ticks, "tick_us": phase_statistics(again), "reference_us": reference.median_us}


def main() -> int:
    """Dance, write, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, help="where to write the ticks (.npz)")
    parser.add_argument("--seconds", type=float, default=4.0, help="how much of the clip to dance")
    args = parser.parse_args()
    danced = dance(Replay("groove", start=2.0, duration=args.seconds), lambda what, share: None)
    motion, log = danced.motion, danced.run.log.trimmed()
    contacts = planted_stack(motion.robot, motion).contacts
    soles = {"soles": np.array([contact.vertices for contact in contacts]), "friction": contacts[0].friction}
    arrays = robot_arrays(motion.robot, log.q[0]) | soles | tick_arrays(motion, log)
    np.savez_compressed(args.file, points=np.array(POINT_NAMES), **arrays)
    print(json.dumps(own_figures(motion, log), indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
