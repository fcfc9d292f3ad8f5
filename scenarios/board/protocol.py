"""What the board measures a run by, step by step against its reference, and when a run has ended for it.

The protocol is that of `mujoco-g1-reference-tracking-50hz-v1`; mjlab's rule for the end of a run stands beside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.robots.robot import Robot

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

RATE_HZ = 50.0
MAX_STEPS = 1000
MAX_ROOT_HEIGHT_ERROR_M = MAX_SHOULDER_HEIGHT_ERROR_M = 0.3
MAX_BODY_ERROR_M = 0.5  # of any body, in the root's frame
LOW_FOOT_HEIGHT_M = 0.05  # of a foot whose speed along the floor is a slip
MJLAB_MAX_HEIGHT_ERROR_M = 0.25  # of the anchor and of the ends of the limbs
MJLAB_MAX_GRAVITY_ERROR = 0.8  # of the vertical component of gravity in the anchor's frame, unit length

ROOT, ANCHOR, SHOULDER = "pelvis", "torso_link", "left_shoulder_roll_link"
ENDS = tuple(f"{side}_{link}_link" for side in ("left", "right") for link in ("ankle_roll", "wrist_yaw"))
BODIES = (
    *(ROOT, ANCHOR),
    *(
        f"{side}_{link}_link"
        for side in ("left", "right")
        for link in ("hip_roll", "knee", "ankle_roll", "shoulder_roll", "elbow", "wrist_yaw")
    ),
)
"""The fourteen links of the G1 that trackers follow; which ones the board takes is not published."""


@dataclass(frozen=True)
class Bodies:
    """Where a robot's links are over time.

    Attributes:
        place: (T, B, 3) of `BODIES`, world [m].
        root, anchor: (T, 3, 3) their rotations.
        soles: (T, 2, 3) middles of the soles, world [m].
    """

    place: Array
    root: Array
    anchor: Array
    soles: Array

    @staticmethod
    def of(robot: Robot, q: Array) -> "Bodies":
        """Those of configurations (T, nq)."""
        model, data = robot.model, robot.model.createData()
        links = [model.getFrameId(name, pin.FrameType.BODY) for name in BODIES]
        feet = [(robot.point(foot), robot.sole(foot).mean(axis=0)) for foot in robot.feet]
        count = len(q)
        place, soles = np.empty((count, len(links), 3)), np.empty((count, len(feet), 3))
        root, anchor = np.empty((count, 3, 3)), np.empty((count, 3, 3))
        for k, configuration in enumerate(q):
            pin.framesForwardKinematics(model, data, configuration)
            place[k] = [data.oMf[link].translation for link in links]
            root[k], anchor[k] = (data.oMf[links[BODIES.index(name)]].rotation for name in (ROOT, ANCHOR))
            soles[k] = [data.oMf[frame].act(middle) for frame, middle in feet]
        return Bodies(place, root, anchor, soles)

    def height(self, names: Sequence[str]) -> Array:
        """(T, n) heights of some of `BODIES` [m]."""
        return self.place[:, [BODIES.index(name) for name in names], 2]

    def in_root(self) -> Array:
        """(T, B, 3) places in the root's frame [m]."""
        own: Array = np.einsum("tji,tbj->tbi", self.root, self.place - self.place[:, :1])
        return own


def laid_at(reference: Array, start: Array) -> Array:
    """A reference (T, nq) turned about the vertical and moved along the floor so that its first root is where the root
    of a configuration (nq,) is, and faces as it does."""
    first, there = (pin.XYZQUATToSE3(q[:7]) for q in (reference[0], start))
    turn = pin.utils.rotate("z", _yaw(there.rotation) - _yaw(first.rotation))
    move = there.translation - turn @ first.translation
    move[2] = 0.0
    laid, place = reference.copy(), pin.SE3(turn, move)
    laid[:, :7] = [pin.SE3ToXYZQUAT(place * pin.XYZQUATToSE3(q[:7])) for q in reference]
    return laid


def board_figures(robot: Robot, reference: Array, done: Array, power: Array, loaded: Flags) -> dict[str, float | None]:
    """The board's columns of a run.

    Args:
        robot: The G1.
        reference: (T, nq) configurations, a step each, where the run starts.
        done: (n, nq) those of the robot at the first n ≤ T steps, fewer than T if it fell.
        power: (n,) mechanical, Σ|τ q̇| [W].
        loaded: (n, 2) whether the floor carries a foot.

    Returns:
        "completion" and "mjlab_completion", share of the steps before either rule ends the run; over the steps before
        the board's does: "local_mpjpe_mm", mean distance of the links from their reference, in the root's frame;
        "joint_mae_rad"; "root_drift_mm", mean distance of the roots; "slip_m_s", mean speed along the floor of soles
        lower than 5 cm, those that swing low among them; "loaded_slip_m_s", of loaded ones; "power_w"; and "steps",
        their number. None where there are no steps.
    """
    count = min(len(done), len(reference))
    ours, theirs = Bodies.of(robot, done[:count]), Bodies.of(robot, reference[:count])
    steps = _steps_before(_ended(ours, theirs))
    figures: dict[str, float | None] = {
        "completion": steps / len(reference),
        "mjlab_completion": _steps_before(_ended_for_mjlab(ours, theirs)) / len(reference),
        "steps": float(steps),
    }
    names = ("local_mpjpe_mm", "joint_mae_rad", "root_drift_mm", "slip_m_s", "loaded_slip_m_s", "power_w")
    if steps < 2:
        return figures | dict.fromkeys(names)
    local = np.linalg.norm(ours.in_root() - theirs.in_root(), axis=2)[:steps]
    drift = np.linalg.norm(ours.place[:steps, 0] - theirs.place[:steps, 0], axis=1)
    angles = np.abs(done[:steps, 7:] - reference[:steps, 7:])
    speed = RATE_HZ * np.linalg.norm(np.diff(ours.soles[:steps, :, :2], axis=0), axis=2)
    low = ours.soles[: steps - 1, :, 2] < LOW_FOOT_HEIGHT_M
    slips = (speed[feet].mean() if feet.any() else 0.0 for feet in (low, loaded[: steps - 1]))
    values = 1e3 * local.mean(), angles.mean(), 1e3 * drift.mean(), *slips, power[:steps].mean()
    return figures | {name: float(value) for name, value in zip(names, values, strict=True)}


def _ended(ours: Bodies, theirs: Bodies) -> Flags:
    """Steps (T,) at which the board ends a run."""
    off = np.abs(ours.height((ROOT, SHOULDER)) - theirs.height((ROOT, SHOULDER)))
    local = np.linalg.norm(ours.in_root() - theirs.in_root(), axis=2).max(axis=1)
    ended: Flags = (off > (MAX_ROOT_HEIGHT_ERROR_M, MAX_SHOULDER_HEIGHT_ERROR_M)).any(axis=1) | (
        local > MAX_BODY_ERROR_M
    )
    return ended


def _ended_for_mjlab(ours: Bodies, theirs: Bodies) -> Flags:
    """Steps (T,) at which mjlab ends a run."""
    names = (ANCHOR, *ENDS)
    high = (np.abs(ours.height(names) - theirs.height(names)) > MJLAB_MAX_HEIGHT_ERROR_M).any(axis=1)
    tilted = np.abs(ours.anchor[:, 2, 2] - theirs.anchor[:, 2, 2]) > MJLAB_MAX_GRAVITY_ERROR
    ended: Flags = high | tilted
    return ended


def _steps_before(ended: Flags) -> int:
    return int(np.argmax(ended)) if ended.any() else len(ended)


def _yaw(rotation: Array) -> float:
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))
