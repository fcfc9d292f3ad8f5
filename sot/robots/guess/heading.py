"""Where a robot looks, and which of its feet is the left one: from toes, knees and names, each with a vote."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.feet import Feet
from sot.robots.guess.posed_model import PosedModel

Array = NDArray[np.float64]

TOE_SHARE = 0.04  # share of the foot's length by which its middle is ahead of the ankle at least, if that says anything
KNEE_SHARE = 2.0  # a knee's range is that much greater to one side at least
MIN_FOOT_LENGTH = 0.01  # share of the height that is too short for a foot
VOTES = {"names": 2, "knees": 2, "toes": 1}
AXIS_SNAP_ANGLE = np.deg2rad(3.0)  # a heading this near a model's axis is along it


@dataclass(frozen=True)
class Heading:
    """How to turn the model so that it looks along x, and its feet.

    Attributes:
        yaw: by which its base has to be turned [rad].
        left, right: the feet's links.
    """

    yaw: float
    left: int
    right: int


def find_heading(posed: PosedModel, feet: Feet) -> tuple[Heading, Evidence]:
    """The heading that most votes are for.

    Raises:
        InputError: nothing speaks for either way.
    """
    first, second = feet.links
    legs = [posed.joints_between(feet.pelvis, foot) for foot in feet.links]
    across = np.mean([posed.axis(j)[0] for j in legs[0]], axis=0) - np.mean([posed.axis(j)[0] for j in legs[1]], axis=0)
    across[2] = 0.0
    across /= np.linalg.norm(across)
    ahead = np.cross(across, (0.0, 0.0, 1.0))  # if the first foot is the left one: y × z = x
    said = {
        "toes": _toes(posed, feet, legs, ahead),
        "knees": _knees(posed, legs, ahead),
        "names": _names([[posed.joint_name(j) for j in leg] for leg in legs]),
    }
    votes = sum(VOTES[name] * vote for name, (vote, _) in said.items())
    if votes == 0:
        raise InputError(
            "neither toes, nor knees, nor names say where the robot looks; turn its base, so that it is +x"
        )
    way = 1 if votes > 0 else -1
    if way < 0:
        ahead = -ahead
    yaw = -float(np.arctan2(ahead[1], ahead[0]))
    square = round(yaw / (np.pi / 2)) * np.pi / 2
    yaw = (
        abs(square)
        if abs(square) > 3.0 and abs(yaw - square) < AXIS_SNAP_ANGLE
        else square
        if abs(yaw - square) < AXIS_SNAP_ANGLE
        else yaw
    )
    left, right = (first, second) if way > 0 else (second, first)
    against = [name for name, (vote, _) in said.items() if vote * way < 0]
    why = "; ".join(words for _, (vote, words) in said.items() if vote)
    if against:
        why += f" ({' and '.join(against)} speak against it)"
    turned = f", turned by {np.rad2deg(yaw):.0f}° to look along x" if abs(yaw) > 1e-6 else ""
    found = f"left is {posed.name(left)}{turned}"
    sureness = Sureness.UNSURE if against else Sureness.SURE if abs(votes) > 2 else Sureness.LIKELY
    return Heading(yaw if abs(yaw) > 1e-6 else 0.0, left, right), Evidence("heading", found, why, sureness)


def turned(posed: PosedModel, yaw: float, qpos: Array) -> Array:
    """A configuration (nq,) with its base turned about the vertical through the origin."""
    out, turn, now = qpos.copy(), np.zeros(4), np.zeros(4)
    first = int(posed.model.jnt_qposadr[posed.model.body_jntadr[posed.base]])
    mujoco.mju_axisAngle2Quat(turn, np.array([0.0, 0.0, 1.0]), yaw)
    mujoco.mju_mulQuat(now, turn, qpos[first + 3 : first + 7])
    at = np.zeros(3)
    mujoco.mju_rotVecQuat(at, qpos[first : first + 3], turn)
    out[first : first + 3], out[first + 3 : first + 7] = at, now
    return out


def _toes(posed: PosedModel, feet: Feet, legs: Sequence[Sequence[int]], ahead: Array) -> tuple[int, str]:
    shares = []
    for foot, leg in zip(feet.links, legs, strict=True):
        along = posed.surface(posed.touching([foot])) @ ahead
        middle = 0.5 * (along.min() + along.max()) - float(posed.axis(leg[-1])[0] @ ahead)
        shares.append(middle / max(float(np.ptp(along)), MIN_FOOT_LENGTH * feet.height))
    share = float(np.mean(shares))
    vote = int(np.sign(share)) if abs(share) > TOE_SHARE else 0
    return vote, f"the feet's middle is {100 * abs(share):.0f} % of their length before the ankle"


def _knees(posed: PosedModel, legs: Sequence[Sequence[int]], ahead: Array) -> tuple[int, str]:
    """Knees bend so that the foot goes back: a joint in the middle of the leg has its range to one side."""
    ways = []
    for leg in legs:
        ankle, hip = posed.axis(leg[-1])[0], posed.axis(leg[0])[0]
        for joint in leg:
            at, axis = posed.axis(joint)
            low, high = posed.range(joint)
            share = (hip[2] - at[2]) / max(hip[2] - ankle[2], 1e-9)
            if not (0.25 < share < 0.85 and np.isfinite([low, high]).all()):
                continue
            wide = max(high, 0.0), max(-low, 0.0)
            if max(wide) > KNEE_SHARE * min(wide):
                bent = 1.0 if wide[0] > wide[1] else -1.0
                ways.append(float(np.sign(-bent * np.cross(axis, ankle - at) @ ahead)))
    vote = int(np.sign(sum(ways))) if ways and abs(sum(ways)) == len(ways) else 0
    return vote, "knees bend to the back"


def _names(legs: Sequence[Sequence[str]]) -> tuple[int, str]:
    """Which leg has names with a left in them, where the names of the other have a right."""
    vote = 0
    for one, other in zip(*legs, strict=False):
        differ = [(a, b) for a, b in zip(one.lower(), other.lower(), strict=False) if a != b]
        if differ and differ[0] in (("l", "r"), ("r", "l")):
            vote += 1 if differ[0][0] == "l" else -1
    return int(np.sign(vote)), "names say left and right"
