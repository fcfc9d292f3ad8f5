"""Clips of ours that walk: ahead, around corners, turning on the spot, stopping, backwards, sideways, over stairs
and over a ramp.

`python -m scenarios.inputs.walks NAME FILE` writes one of them, by a name of `WALKS`.

A walk is a list of footsteps. A foot swings from one to the next along minimum-jerk paths; the hips go with the middle
of both feet and sway over the one that stands, arms swing against the legs. Walks start and end at rest.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.inputs.synthetic_human import (
    ANKLE_FROM_MIDDLE_M,
    ANKLE_HEIGHT_M,
    SHANK_M,
    SIDES,
    THIGH_M,
    bvh_text,
    leg_angles,
)
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

RATE_HZ = 50.0
SWING_S, BETWEEN_S = 0.45, 0.15  # time of a step, and between two
REST_S = 1.0  # s, at both ends
HIP_DROP_M = 0.09  # m, by which the knees are bent
LIFT_M = 0.10  # m, of an ankle in a step
TOES_DOWN_DEG = 20.0  # deg, in the first half of a step
SWAY_M = 0.03  # m, of the hips toward the foot that stands
SMOOTHING_S = 0.16  # s, standard deviation with which the hips follow the feet
STRIDE_M, STRIDE_BACK_M, STRIDE_ASIDE_M = 0.45, 0.3, 0.25  # m, between two footsteps of one walk
STAIR_SWING_S = 0.7  # time of a step from tread to tread
TREAD_RISE_M, TREAD_DEPTH_M = 0.16, 0.30  # m, of stairs
RISE_SHARE = 0.6  # of a step's time, in which the foot gets up to the next tread or, at its end, down to it
STAIR_HIP_DROP = 0.5  # of the height between both feet, by which the hips are lower than over the mean of them
RAMP_DEG, RAMP_STRIDE_M, RAMP_STEPS = 8.0, 0.30, 5  # of a ramp, and of who walks up and down it
ARM_SWING_PER_M = 0.9  # rad per m that the other foot is ahead of the hips
OTHER = {"Left": "Right", "Right": "Left"}


@dataclass
class _Swing:
    """A foot's way to where it stands next: x, z [m], heading [rad], height [m] and slope [rad] of what is there."""

    side: str
    lift: float
    goal: Array
    height: float
    level: float
    slope: float
    time: float


@dataclass
class _Walk:
    """Footsteps as they are written down: the place that the walk has come to, and the foot that goes next."""

    place: Array = field(default_factory=lambda: np.zeros(2))
    heading: float = 0.0
    side: str = "Left"
    t: float = REST_S
    level: float = 0.0
    slope: float = 0.0
    swing_time: float = SWING_S
    swings: list[_Swing] = field(default_factory=list)

    def step(self, ahead: float = 0.0, aside: float = 0.0, turn_deg: float = 0.0) -> None:
        """One foot goes on: the walk's place by so much ahead and to the left [m], turned to the left."""
        self.heading += np.radians(turn_deg)
        forward, left = _axes(self.heading)
        self.place = self.place + ahead * forward + aside * left
        self.set_down(LIFT_M)

    def set_down(self, height: float) -> None:
        """The foot whose turn it is comes down beside the walk's place."""
        goal = self.place + SIDES[self.side] * ANKLE_FROM_MIDDLE_M * _axes(self.heading)[1]
        end = np.append(goal, self.heading)
        self.swings.append(_Swing(self.side, self.t, end, height, self.level, self.slope, self.swing_time))
        self.side = OTHER[self.side]
        self.t += self.swing_time + BETWEEN_S

    def stop(self, seconds: float) -> None:
        """The other foot comes beside the one that stands, and both stay."""
        self.set_down(LIFT_M)
        self.t += seconds


def walk_turns() -> str:
    """Ahead, a quarter turn to the left along a curve, half a turn to the right on the spot, and a curve back."""
    walk = _Walk()
    for _ in range(4):
        walk.step(STRIDE_M)
    for _ in range(6):
        walk.step(0.8 * STRIDE_M, turn_deg=15.0)
    walk.stop(1.0)
    for _ in range(6):
        walk.step(turn_deg=-30.0)
    walk.stop(0.5)
    for _ in range(6):
        walk.step(0.7 * STRIDE_M, turn_deg=-20.0)
    walk.stop(REST_S)
    return _text(walk)


def walk_stops() -> str:
    """Ahead, a stop, two steps more, a stop, backwards, to either side, a foot that is put back, and ahead."""
    walk = _Walk()
    for steps in (4, 2):
        for _ in range(steps):
            walk.step(STRIDE_M)
        walk.stop(1.0)
    for _ in range(4):
        walk.step(-STRIDE_BACK_M)
    walk.stop(1.0)
    for side, sign in SIDES.items():
        walk.side = side
        for _ in range(3):
            walk.step(aside=sign * STRIDE_ASIDE_M)
            walk.set_down(LIFT_M)
        walk.t += 0.5
    walk.set_down(1.5 * LIFT_M)
    walk.t += 0.5
    for _ in range(3):
        walk.step(STRIDE_M)
    walk.stop(REST_S)
    return _text(walk)


def walk_stairs() -> str:
    """Up four treads and down again on the other side, both feet on each of them."""
    return _stairs(steps_on_tread=2)


def walk_stairs_over() -> str:
    """The same, one foot on each of them."""
    return _stairs(steps_on_tread=1)


def _stairs(steps_on_tread: int) -> str:
    walk = _Walk(swing_time=STAIR_SWING_S)
    for rise in (*4 * (TREAD_RISE_M,), *4 * (-TREAD_RISE_M,)):
        walk.level += rise
        walk.step(TREAD_DEPTH_M)
        for _ in range(steps_on_tread - 1):
            walk.step()
    if steps_on_tread == 1:
        walk.step()
    walk.t += REST_S
    return _text(walk)


def walk_ramp() -> str:
    """Up a ramp, two steps on the level above it, and down another one."""
    walk = _Walk()
    walk.step(RAMP_STRIDE_M)
    for degrees, steps in ((RAMP_DEG, RAMP_STEPS), (0.0, 2), (-RAMP_DEG, RAMP_STEPS)):
        walk.slope = np.radians(degrees)
        for _ in range(steps):
            walk.level += RAMP_STRIDE_M * np.tan(walk.slope)
            walk.step(RAMP_STRIDE_M)
    walk.slope, walk.level = 0.0, 0.0
    walk.step(RAMP_STRIDE_M)
    walk.stop(REST_S)
    return _text(walk)


WALKS: dict[str, Callable[[], str]] = {
    "walk_turns": walk_turns,
    "walk_stops": walk_stops,
    "walk_stairs": walk_stairs,
    "walk_stairs_over": walk_stairs_over,
    "walk_ramp": walk_ramp,
}


def write_walk(name: str, path: Path) -> None:
    """Write a clip to a file."""
    path.write_text(WALKS[name](), encoding="ascii", newline="\n")


def _axes(heading: float) -> tuple[Array, Array]:
    """Forward and left (x, z) of a heading [rad]: x points left and z forward at zero."""
    sine, cosine = np.sin(heading), np.cos(heading)
    return np.array([sine, cosine]), np.array([cosine, -sine])


def _text(walk: _Walk) -> str:
    """The clip as the text of a .bvh file, in centimetres, Y up."""
    t = np.arange(round((walk.t + REST_S) * RATE_HZ) + 1) / RATE_HZ
    feet = {side: _foot_way(walk, side, t) for side in SIDES}
    middle = np.mean([way[:, :3] for way in feet.values()], axis=0)
    stands = {side: 1.0 - np.minimum(way[:, 3] / LIFT_M, 1.0) for side, way in feet.items()}
    levels = np.array([way[:, 5] for way in feet.values()])
    ground = _smoothed(levels.mean(axis=0) - STAIR_HIP_DROP * np.ptp(levels, axis=0))
    sway = SWAY_M * (stands["Left"] - stands["Right"])
    ahead, left = _axes(middle[:, 2])
    middle[:, :2] += sway[:, None] * left.T
    middle = np.column_stack([_smoothed(column) for column in middle.T])
    hips = np.column_stack([middle[:, 0], ANKLE_HEIGHT_M + THIGH_M + SHANK_M - HIP_DROP_M + ground, middle[:, 1]])
    pelvis = np.column_stack([middle[:, 2], 0.0 * t, 0.0 * t])
    angles = {"Hips": pelvis}
    for side, sign in SIDES.items():
        x, z, heading, height, pitch, level = feet[side].T
        ankle = np.column_stack([x, ANKLE_HEIGHT_M + level + height, z])
        legs = leg_angles(hips, pelvis, sign, ankle, pitch, heading)
        angles |= {side + joint: angle for joint, angle in legs.items()}
        way = feet[OTHER[side]][:, :2] - hips[:, [0, 2]]
        swing = ARM_SWING_PER_M * np.einsum("tk,kt->t", way, ahead)
        angles[side + "Arm"] = np.column_stack([0.0 * t - sign * 0.14, -swing, 0.0 * t - sign * 1.25])
        angles[side + "ForeArm"] = np.column_stack([0.0 * t - sign * 0.35, 0.0 * t, 0.0 * t])
    return bvh_text(hips, angles, RATE_HZ)


def _foot_way(walk: _Walk, side: str, t: Array) -> Array:
    """x, z [m], heading [rad], height over standing [m], how far the toes point down [rad], and height of what it is
    on [m] of a foot, (T, 6)."""
    at = np.append(SIDES[side] * ANKLE_FROM_MIDDLE_M * _axes(0.0)[1], 0.0)
    way, level, slope = np.tile(np.append(at, [0.0, 0.0, 0.0]), (len(t), 1)), 0.0, 0.0
    for swing in walk.swings:
        if swing.side == side:
            share = np.clip((t - swing.lift) / swing.time, 0.0, 1.0)
            way[:, :3] += minimum_jerk(share)[:, None] * (swing.goal - at)
            way[:, 3] += swing.height * 16.0 * share**2 * (1.0 - share) ** 2
            way[:, 4] += np.radians(TOES_DOWN_DEG) * np.sin(2.0 * np.pi * share) * 4.0 * share * (1.0 - share)
            begin = 0.0 if swing.level > level else 1.0 - RISE_SHARE
            way[:, 5] += (swing.level - level) * minimum_jerk(np.clip((share - begin) / RISE_SHARE, 0.0, 1.0))
            way[:, 4] -= (swing.slope - slope) * minimum_jerk(share)
            at, level, slope = swing.goal, swing.level, swing.slope
    return way


def _smoothed(column: Array) -> Array:
    """A column (T,) that follows smoothly, and stays what it is at the ends."""
    reach = round(4.0 * SMOOTHING_S * RATE_HZ)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / (SMOOTHING_S * RATE_HZ)) ** 2)
    return np.convolve(np.pad(column, reach, mode="edge"), weights / weights.sum(), mode="valid")


if __name__ == "__main__":
    write_walk(sys.argv[1], Path(sys.argv[2]))
