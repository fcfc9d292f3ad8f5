"""A person in the robot's size, over the robot's feet, as it comes; and its targets for the robot's body."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.live.person import Moment, Person
from sot.motion.body.targets import UPPER_BODY_SEGMENTS
from sot.motion.feet.stance import DRIFT_HZ, Build
from sot.motion.human.human import SEGMENTS, SIDES

Array = NDArray[np.float64]

MAX_HIP_SHIFT_LEGS = 0.2
"""Bound of how far the hips go from over the feet, in leg lengths; a person who walks gets ahead of its mean place."""


@dataclass(frozen=True)
class MomentTargets:
    """Targets of the robot's body at one time, in the robot's world; see `sot.motion.body.targets.Targets`.

    Attributes:
        hips: (3,) middle of the hips [m].
        frames: pelvis, chest, head -> (3, 3).
        directions: segment of the upper body -> (3,) unit vector.
        points: the person in the robot's size and place, name -> (3,) [m].
    """

    hips: Array
    frames: dict[str, Array]
    directions: dict[str, Array]
    points: dict[str, Array]


class Placement:
    """Causal form of `human_over_feet`: drift, turning and rise slower than DRIFT_HZ are taken out as they come.

    Args:
        build: the robot's sizes.
        person: the person's.
    """

    def __init__(self, build: Build, person: Person) -> None:
        self._build, self._person = build, person
        self._heading, self._origin = 0.0, np.zeros(3)
        self._seen_at: float | None = None

    def start_anew(self) -> None:
        """Forget where the person was: it is somewhere else now."""
        self._seen_at = None

    def __call__(self, moment: Moment, t: float) -> MomentTargets:
        """Targets of a person at a time [s], not before those of earlier calls."""
        points, build = moment.points, self._build
        ankles = [points[f"{side}_ankle"] for side in SIDES]
        ahead = np.sum([points[f"{side}_toe"] - points[f"{side}_ankle"] for side in SIDES], axis=0)
        place = np.append(0.5 * (ankles[0] + ankles[1])[:2], min(ankles[0][2], ankles[1][2]))
        facing = np.arctan2(ahead[1], ahead[0])
        if self._seen_at is None:
            self._heading, self._origin = facing, place
        else:
            share = 1.0 - np.exp(-2.0 * np.pi * DRIFT_HZ * (t - self._seen_at))
            self._heading += share * _wrapped(facing - self._heading)
            self._origin = self._origin + share * (place - self._origin)
        self._seen_at = t
        pelvis = moment.frames["pelvis"]
        twist = _wrapped(np.arctan2(pelvis[1, 0], pelvis[0, 0]) - self._heading)
        heading = self._heading + twist - float(np.clip(twist, -build.turn, build.turn))
        return person_placed(moment, build, self._person, turn_about_z(-heading), self._origin, build.ankles)


def person_placed(
    moment: Moment, build: Build, person: Person, turn: Array, origin: Array, over: Array
) -> MomentTargets:
    """Targets of a person in the robot's size, turned by a rotation (3, 3) and moved.

    Args:
        moment: the person.
        build: the robot's sizes.
        person: the person's.
        turn: about the vertical.
        origin: the place in the person's world (3,) that comes to lie
        over: this one of the robot's (3,) [m].
    """
    scale = build.leg / person.leg
    chest_share = min(1.0, (person.breadth / person.arm) / (build.breadth / build.arm))
    placed = {name: over + scale * (turn @ (place - origin)) for name, place in moment.points.items()}
    frames = {body: turn @ rotation for body, rotation in moment.frames.items()}
    chest = frames["chest"]
    yaw = np.arctan2(chest[1, 0], chest[0, 0])
    frames["chest"] = turn_about_z((chest_share - 1.0) * yaw) @ chest
    directions = {}
    for segment in UPPER_BODY_SEGMENTS:
        near, far = SEGMENTS[segment]
        along = placed[far] - placed[near]
        directions[segment] = along / max(float(np.linalg.norm(along)), 1e-9)
    hips, most = placed["waist"].copy(), MAX_HIP_SHIFT_LEGS * build.leg
    away = hips[:2] - over[:2]
    hips[:2] = over[:2] + away * min(1.0, most / max(float(np.linalg.norm(away)), 1e-9))
    return MomentTargets(hips, frames, directions, placed)


def _wrapped(angle: float) -> float:
    """The angle within ±π [rad]."""
    return float(np.arctan2(np.sin(angle), np.cos(angle)))


def turn_about_z(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
