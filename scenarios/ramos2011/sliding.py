"""The robot slides ahead, Ramos IV-C: one foot after the other glides over the floor while the other one stands."""

import numpy as np

from scenarios import stacks
from sot.motion.balance.feet_led import feet_led
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.slides import Slide, SlideWay, paths_with_slides, phases_with_slides, slide_duration
from sot.motion.feet.swing import standing_paths
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

KNOT_PERIOD = 0.02  # s, between knots
FEET_IN_ORDER = ("right_foot", "left_foot")
SLIDE_WAY: SlideWay = (0.085, 0.0, 0.05)  # of each foot: forward [m], sideways [m], turn of the toes outward [rad]
STANDING_TIME = 1.2  # s on both feet, before and after each slide


def motion(robot: Robot, rate: float) -> Motion:
    """Motion that shifts the weight and slides one foot, then the other one, and stands on both again."""
    slides, now = [], STANDING_TIME
    for foot in FEET_IN_ORDER:
        end = now + slide_duration(SLIDE_WAY, robot)
        slides.append(Slide(foot, now, end, SLIDE_WAY))
        now = end + STANDING_TIME
    times = KNOT_PERIOD * np.arange(round(now / KNOT_PERIOD) + 1, dtype=float)
    phases = planted_phases(robot, float(times[-1]))
    paths = paths_with_slides(standing_paths(phases[0], len(times)), slides, robot, times)
    return feet_led(robot, phases_with_slides(phases, slides, robot), paths, KNOT_PERIOD, rate)


stack, schedule = stacks.sliding_stack, stacks.sliding_schedule
