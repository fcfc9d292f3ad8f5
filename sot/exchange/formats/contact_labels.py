"""ProtoMotions' contact labels: <clip>_contacts.npz with foot_contacts (T, 2), left and right, beside a motion."""

from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.exchange.robot_motion import RobotMotion


def write(motion: RobotMotion, path: Path) -> None:
    """Write which feet are on the floor in each frame.

    Raises:
        InputError: nobody knows of this motion.
    """
    if motion.contacts is None:
        raise InputError(f"{path}: the motion has no contacts to label")
    np.savez(path, foot_contacts=motion.contacts.astype(np.float32), fps=np.array(motion.rate))
