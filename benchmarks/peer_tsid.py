"""TSID on the ticks of our own dance: one weighted level in C++ (Del Prete et al.), called from Python.

It needs an environment of its own, since its wheel wants an older Pinocchio than we do:

    python3.11 -m venv build/peer
    build/peer/bin/pip install --only-binary :all: "tsid==1.7.1" "pin==3.4.0" "coal<3.0.2" "cmeel-urdfdom<5" \\
        "cmeel-tinyxml2<11" "cmeel-console-bridge<2"

    python benchmarks/peer_ticks.py ticks.npz > ours.json
    OMP_NUM_THREADS=1 build/peer/bin/python -W ignore benchmarks/peer_tsid.py ticks.npz > tsid.json
    sot bench --peer ours.json --peer tsid.json

The same robot (its mass matrix is compared), the same states, soles, friction, torque bounds, ranges, velocities and
accelerations, and the references of the planted stack: centre of mass, waist orientation, posture, least forces. Not
the same: TSID weighs what the stack puts into strict levels, has no distances between bodies, no damping or friction in
the joints, and no divergent component of motion.
"""

import argparse
import importlib.util
import json
import sys
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any

import numpy as np
import pinocchio as pin

VERSION = "1.7.1"
KP, KD = 100.0, 20.0  # as in the stack
WEIGHTS = {"com": 1.0, "waist": 0.1, "posture": 0.01, "forces": 1e-5}
MAX_FOOT_FORCE = 1e4  # N, of a foot: no limit
TICKS_PER_REFERENCE = 20  # ticks, between two runs of the reference computation
PERCENTILES = {"p50": 50.0, "p95": 95.0, "p99": 99.0}


def load_tsid() -> ModuleType:
    """The compiled module, which the wheel puts where Python does not look for it."""
    site = Path(pin.__file__).parents[1]
    (library,) = site.glob("tsid/tsid_pywrap*.so")
    spec = importlib.util.spec_from_file_location("tsid.tsid_pywrap", library)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def build_model(ticks: Any) -> pin.Model:
    """The robot of a file of `peer_ticks.py`.

    Raises:
        ValueError: its mass matrix is another than there.
    """
    model = pin.Model()
    placements = [pin.SE3(matrix) for matrix in ticks["placements"]]
    joints = [pin.JointModelFreeFlyer(), *(_revolute(axis) for axis in ticks["axes"])]
    names, parents = ["root_joint", *ticks["names"].tolist()], [0, *ticks["parents"].tolist()]
    for k, (joint, name) in enumerate(zip(joints, names, strict=True)):
        index = model.addJoint(parents[k], joint, placements[k], name)
        inertia = pin.Inertia(float(ticks["masses"][k]), ticks["levers"][k], ticks["inertias"][k])
        model.appendBodyToJoint(index, inertia, pin.SE3.Identity())
    for name, joint, placement in zip(
        ticks["points"].tolist(), ticks["point_joints"], ticks["point_placements"], strict=True
    ):
        model.addFrame(pin.Frame(name, int(joint), pin.SE3(placement), pin.FrameType.OP_FRAME))
    model.armature = ticks["armature"]
    M = pin.crba(model, model.createData(), ticks["q"][0])
    if not np.allclose(np.triu(M), np.triu(ticks["mass_matrix"]), atol=1e-9):
        raise ValueError("this is not the robot that danced: its mass matrix differs")
    return model


def _revolute(axis: np.ndarray) -> Any:
    aligned = (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ)
    for kind, direction in zip(aligned, np.eye(3), strict=True):
        if np.allclose(axis, direction):
            return kind()
    return pin.JointModelRevoluteUnaligned(axis)


class TsidController:
    """TSID's controller with the tasks of the planted stack."""

    def __init__(self, tsid: ModuleType, ticks: Any) -> None:
        self._tsid, self._ticks = tsid, ticks
        model = build_model(ticks)
        self._robot = tsid.RobotWrapper(model, tsid.RootJointType.FLOATING_BASE_SYSTEM, False)
        robot, joints = self._robot, len(ticks["names"])
        self._dynamics = tsid.InverseDynamicsFormulationAccForce("peer", robot, False)
        self._dynamics.computeProblemData(0.0, ticks["q"][0], ticks["v"][0])
        self._kept: list[Any] = []  # TSID refers to what it is given, and does not keep it alive
        for foot, sole in zip(ticks["points"][1:].tolist(), ticks["soles"], strict=True):
            self._add_contact(foot, sole, float(ticks["friction"]) / np.sqrt(2.0))

        self._com, self._posture = tsid.TaskComEquality("com", robot), tsid.TaskJointPosture("posture", robot)
        self._waist = tsid.TaskSE3Equality("waist", robot, "waist")
        for task, size in ((self._com, 3), (self._posture, joints), (self._waist, 6)):
            task.setKp(KP * np.ones(size))
            task.setKd(KD * np.ones(size))
        self._waist.useLocalFrame(False)
        self._waist.setMask(np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]))  # before it is added, which fixes its size
        for task in (self._com, self._waist, self._posture):
            self._dynamics.addMotionTask(task, WEIGHTS[task.name], 1, 0.0)
        self._add_bounds()
        self._solver = tsid.SolverHQuadProgFast("solver")
        self._solver.resize(self._dynamics.nVar, self._dynamics.nEq, self._dynamics.nIn)
        self._samples = [tsid.TrajectorySample(3), tsid.TrajectorySample(12, 6), tsid.TrajectorySample(joints)]
        waist = [pin.SE3(rotation, np.zeros(3)) for rotation in ticks["waist_rotation"]]
        self._wanted = list(
            zip(
                zip(*ticks["com"], strict=True),
                zip(waist, *ticks["waist_motion"], strict=True),
                zip(*ticks["joints"], strict=True),
                strict=True,
            )
        )

    @property
    def problem_size(self) -> dict[str, int]:
        """Of the quadratic program."""
        return {
            "variables": self._dynamics.nVar,
            "equalities": self._dynamics.nEq,
            "inequalities": self._dynamics.nIn,
        }

    def _add_contact(self, foot: str, sole: np.ndarray, friction: float) -> None:
        corners, normal = np.asfortranarray(sole.T), np.array([0.0, 0.0, 1.0])
        contact = self._tsid.Contact6d(foot, self._robot, foot, corners, normal, friction, 0.0, MAX_FOOT_FORCE)
        contact.setKp(KP * np.ones(6))
        contact.setKd(KD * np.ones(6))
        contact.setReference(self._robot.framePosition(self._dynamics.data(), self._robot.model().getFrameId(foot)))
        self._dynamics.addRigidContact(contact, WEIGHTS["forces"], 1.0, 0)
        self._kept.append(contact)

    def _add_bounds(self) -> None:
        ticks, robot = self._ticks, self._robot
        torque = self._tsid.TaskActuationBounds("torque", robot)
        torque.setBounds(-ticks["effort"], ticks["effort"])
        self._dynamics.addActuationTask(torque, 1.0, 0, 0.0)
        joints = self._tsid.TaskJointPosVelAccBounds("joints", robot, float(ticks["period"]), False)
        joints.setPositionBounds(ticks["lower"], ticks["upper"])
        joints.setVelocityBounds(ticks["velocity"])
        joints.setAccelerationBounds(ticks["acceleration"])
        joints.setImposeBounds(True, True, True, True)
        self._dynamics.addMotionTask(joints, 1.0, 0, 0.0)
        self._kept += [torque, joints]

    def __call__(self, k: int) -> tuple[float, float, bool]:
        """Solve a tick: time of references and problem data, and of solution and torques [s]; whether it was solved."""
        ticks = self._ticks
        q, v, samples = ticks["q"][k], ticks["v"][k], self._samples
        start = perf_counter()
        for task, sample, wanted in zip((self._com, self._waist, self._posture), samples, self._wanted[k], strict=True):
            sample.value(wanted[0])
            sample.derivative(wanted[1])
            sample.second_derivative(wanted[2])
            task.setReference(sample)
        problem = self._dynamics.computeProblemData(k * float(ticks["period"]), q, v)
        built = perf_counter()
        solution = self._solver.solve(problem)
        torque = self._dynamics.getActuatorForces(solution)
        solved = perf_counter()
        return built - start, solved - built, solution.status == 0 and bool(np.isfinite(torque).all())


def statistics_us(times: np.ndarray) -> dict[str, float]:
    """Of times [s], in microseconds."""
    return {key: float(1e6 * np.percentile(times, share)) for key, share in PERCENTILES.items()} | {
        "mean": float(1e6 * np.mean(times))
    }


def reference_us(matrix: np.ndarray) -> float:
    """Time of the computation by which machines are compared, see `sim/reference.py`."""
    start = perf_counter()
    np.linalg.qr(matrix, mode="complete")
    return 1e6 * (perf_counter() - start)


def main() -> int:
    """Solve all ticks and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, help="ticks that peer_ticks.py has written (.npz)")
    args = parser.parse_args()
    with np.load(args.file) as file:
        ticks = {name: file[name] for name in file.files}
    peer = TsidController(load_tsid(), ticks)
    count = len(ticks["q"])
    matrix, reference, rows = np.random.default_rng(0).normal(size=(62, 18)), [], []
    for k in range(count):
        rows.append(peer(k))
        if k % TICKS_PER_REFERENCE == 0:
            reference.append(reference_us(matrix))
    build, solve, solved = (np.array(column) for column in zip(*rows, strict=True))
    figures = {
        "name": f"TSID {VERSION}, in a tight loop",
        "ticks": count,
        "unsolved": int(np.count_nonzero(~solved)),
        "size": peer.problem_size,
        "tick_us": {
            "whole": statistics_us(build + solve),
            "build": statistics_us(build),
            "solve": statistics_us(solve),
        },
        "reference_us": float(np.median(reference)),
    }
    print(json.dumps(figures, indent=2))
    return 1 if figures["unsolved"] else 0


if __name__ == "__main__":
    sys.exit(main())
