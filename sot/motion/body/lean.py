"""Leans of pelvis and trunk within what the robot's legs and waist do."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.robots.lean_range import lean_of, pelvis_leans, trunk_leans
from sot.robots.robot import Robot

Array = NDArray[np.float64]

MIN_TOLD_CUT = np.deg2rad(3.0)  # of a lean, that is worth a sentence


@dataclass(frozen=True)
class LeanCut:
    """How much less a trunk leans than the dancer's where it is most [rad], and when [s]."""

    angle: float
    time: float


def with_leans_in_range(
    robot: Robot, frames: dict[str, Array], directions: dict[str, Array], facing: Array
) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Frames and directions of a body whose pelvis leans no farther than `pelvis_leans`, and trunk and chest no farther
    than `trunk_leans`, seen from a heading; and how much less the trunk leans (T,) [rad].

    Args:
        robot: whose legs and waist.
        frames: pelvis, chest and others -> (T, 3, 3).
        directions: trunk and others -> (T, 3).
        facing: (T,) heading of the feet [rad].
    """
    pelvis, trunk = pelvis_leans(robot), trunk_leans(robot)
    limited = {
        body: (_turn_within(leans, frames[body][:, :, 2], facing) * Rotation.from_matrix(frames[body])).as_matrix()
        for body, leans in (("pelvis", pelvis), ("chest", trunk))
    }
    turn = _turn_within(trunk, directions["trunk"], facing)
    return frames | limited, directions | {"trunk": turn.apply(directions["trunk"])}, turn.magnitude()


def lean_cut(cut: Array, period: float) -> LeanCut | None:
    """The greatest of how much less a trunk leans (T,) at knots [rad], `period` apart [s]; None where it is nothing."""
    worst = int(cut.argmax())
    return LeanCut(float(cut[worst]), period * worst) if cut[worst] > MIN_TOLD_CUT else None


def lean_remark(cut: LeanCut, clip_time: Callable[[float], float]) -> str:
    """The sentence that says how much less the trunk leans. clip_time: from the motion's time to the clip's [s]."""
    return (
        f"The trunk leans less than the dancer's, most of all by {np.rad2deg(cut.angle):.0f} degrees at "
        f"{clip_time(cut.time):.1f} s: legs would meet under a pelvis that leans farther."
    )


def _turn_within(leans: Array, axes: Array, facing: Array) -> Rotation:
    """The turns that bring axes (T, 3) to where their leans, seen from a heading (T,), are within bounds (2, 2)."""
    cosine, sine = np.cos(facing), np.sin(facing)
    to_world = np.array([[cosine, -sine], [sine, cosine]]).transpose(2, 0, 1)
    lean = lean_of(axes)
    nearest = np.clip(np.einsum("tji,tj->ti", to_world, lean), *leans)
    return _upright_to(np.einsum("tij,tj->ti", to_world, nearest)) * _upright_to(lean).inv()


def _upright_to(lean: Array) -> Rotation:
    """The turns from upright to leans (T, 2) [rad]."""
    return Rotation.from_rotvec(np.column_stack([-lean[:, 1], lean[:, 0], np.zeros(len(lean))]))
