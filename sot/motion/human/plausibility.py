"""What no human does: recordings that are damaged beyond mending are refused."""

import numpy as np

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.human.human import Human

MAX_REACH_LEGS = 3.0  # leg lengths, from a human's waist to any of its points
MAX_SPEED_FROUDE = 5.0  # speed over √(g leg), of a waist for a tenth of the time
SPEED_PERCENTILE = 90.0


def check_plausible(human: Human) -> Human:
    """The human itself, if a body can have its proportions and its speed.

    Raises:
        InputError: a point is out of the body's reach, or the body is faster than any.
    """
    waist = human.points["waist"]
    for name, place in human.points.items():
        far = np.linalg.norm(place - waist, axis=1)
        if far.max() > MAX_REACH_LEGS * human.leg:
            raise InputError(
                f"{human.name}: its {name} is {far.max():.1f} m from its waist at {far.argmax() / human.rate:.2f} s,"
                f" with legs of {human.leg:.2f} m: the recording is damaged, or another joint has that name"
            )
    speed = float(np.percentile(np.linalg.norm(np.diff(waist, axis=0), axis=1) * human.rate, SPEED_PERCENTILE))
    if speed > MAX_SPEED_FROUDE * GRAVITY * human.leg_time:
        raise InputError(
            f"{human.name}: its waist moves at {speed:.0f} m/s or more for a tenth of the time: the recording is"
            " damaged, or its frame time is wrong"
        )
    return human
