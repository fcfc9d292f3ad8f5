from dataclasses import replace

import numpy as np
import pytest

from sot.motion.balance.long_stance import CENTRED_SHARE, centred_on_long_stances
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.support import support_over
from sot.motion.feet.swing import FootPath, standing_paths
from sot.robots.robot import Robot

PERIOD = 0.02


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def phases_with_stance(robot: Robot, time: float) -> tuple[Phase, ...]:
    """Both feet, the left one alone for some time [s], and both again."""
    both = planted_phases(robot, 1.0)[0].feet
    alone = {"left_foot": both["left_foot"]}
    return Phase(0.0, 2.0, both), Phase(2.0, 2.0 + time, alone), Phase(2.0 + time, 4.0 + time, both)


def between_feet(time: float) -> np.ndarray:
    """A centre of mass that stays in the middle between both feet, at the knots."""
    return np.zeros((round((4.0 + time) / PERIOD) + 1, 2))


def with_right_foot_raised(phases: tuple[Phase, ...], lift: float) -> dict[str, FootPath]:
    """The feet's paths, the right foot raised by some height [m] while the left one stands alone."""
    count = len(between_feet(phases[1].end - phases[1].start))
    paths = standing_paths(phases[0], count)
    times = PERIOD * np.arange(count)
    raised = paths["right_foot"].position.copy()
    raised[(times > phases[1].start + 0.3) & (times < phases[1].end - 0.3), 2] += lift
    return {**paths, "right_foot": replace(paths["right_foot"], position=raised)}


def test_a_long_stance_has_the_centre_of_mass_over_the_middle_of_the_foot(robot):
    phases, com = phases_with_stance(robot, 3.0), between_feet(3.0)
    centred = centred_on_long_stances(robot, phases, with_right_foot_raised(phases, 0.4), com, PERIOD)
    held = support_over(robot, phases[1], 2.0, 0.0).inset
    middle = round(3.5 / PERIOD)
    room = held.offsets - held.normals @ held.centre
    used = (held.normals @ (centred[middle] - held.centre)) / room
    assert used.max() == pytest.approx(CENTRED_SHARE, abs=1e-6)
    assert not centred[: round(2.0 / PERIOD)].any() and not centred[round(5.0 / PERIOD) :].any()
    assert np.abs(np.diff(centred, 2, axis=0)).max() / PERIOD**2 < 2.0  # m/s²


def test_what_is_centred_stays(robot):
    phases = phases_with_stance(robot, 3.0)
    feet = with_right_foot_raised(phases, 0.4)
    once = centred_on_long_stances(robot, phases, feet, between_feet(3.0), PERIOD)
    middle = slice(round(2.7 / PERIOD), round(4.3 / PERIOD))
    twice = centred_on_long_stances(robot, phases, feet, once, PERIOD)
    np.testing.assert_allclose(twice[middle], once[middle], atol=1e-9)


@pytest.mark.parametrize(("time", "lift"), [(0.8, 0.4), (3.0, 0.1)])
def test_a_step_and_a_low_foot_are_as_they_were(robot, time, lift):
    phases, com = phases_with_stance(robot, time), between_feet(time)
    feet = with_right_foot_raised(phases, lift)
    np.testing.assert_array_equal(centred_on_long_stances(robot, phases, feet, com, PERIOD), com)
