"""A small motion that steps: weight onto one foot, the other forward and down again, and the same with the other."""

import numpy as np
import pinocchio as pin

from sot.motion.balance.feet_led import feet_led
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.swing import FootPath, standing_paths
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

Array = np.ndarray

PERIOD = 0.02
AHEAD = np.array([1.0, 0.0, 0.0])
FIRST, STAND, SWING, LAST = 1.2, 0.5, 0.6, 1.2
"""Times [s]: before the first step, between steps, in the air, after the last."""


def stepping_motion(robot: Robot, stride: float = 0.05, height: float = 0.04, rate: float = 1000.0) -> Motion:
    """The robot steps forward with its right foot, then with its left.

    Args:
        robot: who steps.
        stride: length of a step [m].
        height: of the foot's path [m].
        rate: of the motion [Hz].
    """
    phases = _phases(robot, stride)
    times = np.arange(round(phases[-1].end / PERIOD) + 1) * PERIOD
    paths = standing_paths(phases[0], len(times))
    for swing, after in zip(phases[1::2], phases[2::2], strict=True):
        foot = next(foot for foot in robot.feet if foot not in swing.feet)
        _step(paths[foot], np.clip((times - swing.start) / SWING, 0.0, 1.0), after.feet[foot], height)
    return feet_led(robot, phases, paths, PERIOD, rate)


def _phases(robot: Robot, stride: float) -> tuple[Phase, ...]:
    here = dict(planted_phases(robot, 0.0)[0].feet)
    phases, end = [Phase(0.0, FIRST, dict(here))], FIRST
    for foot in reversed(robot.feet):
        phases.append(Phase(end, end + SWING, {name: pose for name, pose in here.items() if name != foot}))
        here[foot] = pin.SE3(here[foot].rotation, here[foot].translation + stride * AHEAD)
        end += SWING
        phases.append(Phase(end, end + STAND, dict(here)))
        end += STAND
    return (*phases[:-1], Phase(phases[-1].start, end - STAND + LAST, dict(here)))


def _step(path: FootPath, x: Array, there: pin.SE3, height: float) -> None:
    """From where the foot stands to another place over the share x (T,), at rest and unaccelerated at both ends."""
    share = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    path.position[:] += share[:, None] * (there.translation - path.position[0])
    path.position[:, 2] += height * 64.0 * (x * (1.0 - x)) ** 3
