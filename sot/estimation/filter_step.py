"""One step of the contact filter, compiled: readings, and what is planned of the feet, move the belief."""

from typing import NamedTuple

import numpy as np

from solvers.compiled import compiled
from sot.estimation import invariant
from sot.estimation.invariant import Belief
from sot.rotation import quaternion

Array = np.ndarray

TOUCH_SHARE, LEAVE_SHARE = 0.05, 0.02
"""Load over the robot's weight from which a foot counts as standing, and below which it no longer does."""
FIRM_SHARE = 0.2
"""Load over the robot's weight from which a foot is trusted not to slip, and its sole to lie flat."""
SLIP_GATE = 22.46
"""Squared Mahalanobis distance of a foot's six coordinates beyond which it has moved: chi-square, 99.9 %."""


class FootBeliefs(NamedTuple):
    """What is known of the feet beside the belief, arrays that are written in place.

    Args:
        standing: Which feet are part of the belief (feet,).
        slips: In how many readings each has been found to slip (feet,).
        share: What each carries, over the robot's weight (feet,).
    """

    standing: Array
    slips: Array
    share: Array

    @staticmethod
    def in_the_air(feet: int) -> "FootBeliefs":
        return FootBeliefs(np.zeros(feet, dtype=np.bool_), np.zeros(feet, dtype=np.int64), np.zeros(feet))


class SeenFeet(NamedTuple):
    """Feet by the readings of joints and force sensors.

    Args:
        position: Of the soles in the inertial unit's frame (feet, 3) [m].
        rotation: Of the soles in that frame (feet, 3, 3).
        force: Of the sole on the foot, in the foot's axes (feet, 3) [N].
        own_weight: Of what is below the sensor (feet,) [N].
    """

    position: Array
    rotation: Array
    force: Array
    own_weight: Array

    @staticmethod
    def empty(feet: int) -> "SeenFeet":
        turns = np.stack([np.eye(3)] * feet)
        return SeenFeet(np.zeros((feet, 3)), turns, np.zeros((feet, 3)), np.zeros(feet))


class PlannedFeet(NamedTuple):
    """What is planned of the feet, places counted from the belief's origin; nan where nothing is known.

    Args:
        standing: Which are to stand (feet,).
        normal: Of the floor under each (feet, 3).
        height: Of that floor along its normal (feet,) [m].
        position: Of its foothold (feet, 3) [m].
        rotation: Of its foothold (feet, 3, 3).
    """

    standing: Array
    normal: Array
    height: Array
    position: Array
    rotation: Array

    @staticmethod
    def empty(feet: int) -> "PlannedFeet":
        none = np.full((feet, 3), np.nan)
        return PlannedFeet(
            np.zeros(feet, dtype=np.bool_), none.copy(), none[:, 0].copy(), none, np.full((feet, 3, 3), np.nan)
        )


class Variances(NamedTuple):
    """How far readings, feet and floor are trusted.

    Args:
        inertial: Of a reading of gyro and accelerometer (6,).
        sight: Of a sole's place as it is seen (6,).
        floor: Of the floor's height and its roll and pitch (3,), each error for a correlation time.
        foothold: Of a foothold's x, y and heading (3,), each error for a correlation time.
        walk: Of biases and feet that carry their share, a second (15 + 6 feet,).
    """

    inertial: Array
    sight: Array
    floor: Array
    foothold: Array
    walk: Array


@compiled
def filter_step(
    belief: Belief,
    feet: FootBeliefs,
    seen: SeenFeet,
    planned: PlannedFeet,
    variances: Variances,
    gyro: Array,
    accelerometer: Array,
    gravity: float,
    passed: float,
    weight: float,
    correlation_time: float,
) -> None:
    """Carry a belief over the time since the last readings, and correct it by the feet that stand.

    Args:
        belief, feet: Are changed.
        seen: Feet by the readings.
        planned: What is planned of them.
        variances: How far all that is trusted.
        gyro, accelerometer: Mean readings (3,) over the time [rad/s, m/s²].
        gravity: [m/s²].
        passed: Time since the last readings [s]; 0 for the first ones.
        weight: Of the robot [N].
        correlation_time: For which an error of floor or foothold lasts [s].
    """
    if passed > 0.0:
        walk = _walk(feet.share, variances.walk, passed)
        invariant.advance(belief, gyro, accelerometer, gravity, passed, variances.inertial, walk)
    for k in range(len(feet.share)):
        up = belief.rotation[2] @ seen.rotation[k]
        feet.share[k] = (up @ seen.force[k] + seen.own_weight[k]) / weight
    for k in range(len(feet.share)):
        _correct_by_foot(belief, feet, seen, planned, variances, k, passed / correlation_time)


@compiled
def _walk(shares: Array, rate: Array, passed: float) -> Array:
    """Variance (15 + 6 feet,) that biases and feet gain in a time [s]."""
    out = rate * passed
    for k, share in enumerate(shares):
        if share < FIRM_SHARE:
            looseness = (FIRM_SHARE / max(share, LEAVE_SHARE)) ** 2
            at = invariant.FEET + invariant.FOOT * k
            out[at : at + invariant.FOOT] *= looseness**2
    return out


@compiled
def _correct_by_foot(
    belief: Belief,
    feet: FootBeliefs,
    seen: SeenFeet,
    planned: PlannedFeet,
    variances: Variances,
    k: int,
    errors_passed: float,
) -> None:
    """Correct by foot k, for whose floor and foothold this many errors of theirs have passed."""
    position, rotation, share = seen.position[k], seen.rotation[k], feet.share[k]
    if not planned.standing[k] or share < (LEAVE_SHARE if feet.standing[k] else TOUCH_SHARE):
        if feet.standing[k]:
            feet.standing[k] = False
            invariant.forget_foot(belief, k)
        return
    if not feet.standing[k]:
        feet.standing[k] = True
        invariant.place_foot(belief, k, position, rotation, variances.sight)
    elif invariant.see_foot(belief, k, position, rotation, variances.sight, SLIP_GATE):
        feet.slips[k] += 1
    if share < FIRM_SHARE or not errors_passed > 0.0:
        return
    if not np.isnan(planned.height[k]):
        invariant.lay_flat(belief, k, planned.normal[k], planned.height[k], variances.floor / errors_passed)
    if not np.isnan(planned.position[k, 0]):
        place = planned.position[k], planned.rotation[k]
        invariant.put_on_foothold(belief, k, place[0], place[1], variances.foothold / errors_passed)


@compiled
def robot_state(
    belief: Belief,
    then: Array,
    now: Array,
    gravity: float,
    age: float,
    unit_in_base: tuple[Array, Array],
    origin: Array,
    joint_position: Array,
) -> tuple[Array, Array]:
    """A belief as the state (q, v) of its robot, carried on from the readings' stamp.

    Args:
        belief: Of the inertial unit.
        then, now: Gyro, accelerometer and joint rates (6 + joints,), at the stamp and now.
        gravity: [m/s²].
        age: For how long the belief is carried on [s].
        unit_in_base: Rotation (3, 3) and position (3,).
        origin: That the belief's positions are counted from (3,) [m].
        joint_position: At the stamp (joints,) [rad].
    """
    rotation, position, velocity = invariant.base_state(
        belief, then[:3], now[:3], then[3:6], gravity, age, unit_in_base
    )
    q, v = np.empty(7 + len(joint_position)), np.empty(6 + len(joint_position))
    q[:3], q[3:7] = origin + position, quaternion(rotation)
    q[7:] = joint_position + 0.5 * age * (then[6:] + now[6:])
    v[:6], v[6:] = velocity, now[6:]
    return q, v
