"""The damping controller on a pendulum that is pushed, and between supports."""

import numpy as np
import pinocchio as pin
import pytest

from sot.motion.feet.contacts import Phase
from sot.servo.damping import DampingController, PlaneDesigns, single_support_share
from sot.servo.pendulum import Pendulum
from sot.servo.pole_placement import design_damping

DOUBLE = Pendulum(58.0, 0.78, 4900.0, 50.0, 8.0)
SINGLE = Pendulum(58.0, 0.78, 2450.0, 25.0, 8.0)
PERIOD = 0.005
REACH = np.array([0.1, 0.1])


def controller(ratio: float, share=lambda t: 0.0, reach=REACH) -> DampingController:
    designs = PlaneDesigns(design_damping(DOUBLE, ratio, PERIOD), design_damping(SINGLE, ratio, PERIOD))
    return DampingController((designs, designs), share, reach)


def sway(pendulum: Pendulum, damping: DampingController | None, duration: float = 3.0) -> np.ndarray:
    """Zero-moment point of a pendulum that was struck, sample by sample; the reference moves in straight lines."""
    p, share = pendulum, pendulum.mass * pendulum.length**2 / pendulum.turning_inertia
    z, rate, u, slope, found = 0.0, 6.0 / p.turning_inertia, 0.0, 0.0, []
    for k in range(round(duration / PERIOD)):
        y = (p.stiffness * (z - share * u) + p.damping * (rate - share * slope)) / p.weight
        found.append(y)
        wanted = float(damping(k * PERIOD, np.array([y, 0.0]))[0]) / p.length if damping else 0.0
        slope, begin = (wanted - u) / PERIOD, u
        for i in range(10):
            h = PERIOD / 10
            u = begin + (i + 0.5) * h * slope
            delta, turning = z - share * u, rate - share * slope
            moment = p.weight * p.length * (delta + u) - p.stiffness * delta - p.damping * turning
            rate += h * moment / p.turning_inertia
            z += h * rate
        u = wanted
    return np.array(found)


def swing_back(zmp: np.ndarray) -> float:
    return float(-zmp.min() / zmp.max())


@pytest.mark.parametrize("ratio", [0.3, 0.5, 0.72])
def test_a_struck_pendulum_sways_with_the_damping_ratio_that_was_asked_for(ratio):
    found = swing_back(sway(DOUBLE, controller(ratio)))
    assert found == pytest.approx(np.exp(-np.pi * ratio / np.sqrt(1.0 - ratio**2)), abs=0.05)
    assert swing_back(sway(DOUBLE, None)) > 0.8


def test_single_support_has_gains_of_its_own():
    assert swing_back(sway(SINGLE, controller(0.72, lambda t: 1.0))) < 0.1
    assert np.abs(sway(SINGLE, controller(0.72, lambda t: 1.0)))[-100:].max() < 1e-3


def test_nothing_jumps_between_supports():
    """The support changes in the middle of a sway: the reference moves no faster than it does without."""
    phases = (
        Phase(0.0, 0.3, {"left_foot": pin.SE3.Identity(), "right_foot": pin.SE3.Identity()}),
        Phase(0.3, 9.0, {"left_foot": pin.SE3.Identity()}),
    )
    found = []
    for share in (lambda t: 0.0, single_support_share(phases, 0.1)):
        damping = controller(0.72, share)
        shifts = [damping(k * PERIOD, np.array([0.03 * np.sin(8.0 * k * PERIOD), 0.0]))[0] for k in range(200)]
        found.append(np.abs(np.diff(shifts)).max())
    assert found[1] < 1.5 * found[0]


def test_share_of_single_support_rises_and_falls_over_a_ramp():
    both, one = {"left_foot": pin.SE3.Identity(), "right_foot": pin.SE3.Identity()}, {"left_foot": pin.SE3.Identity()}
    share = single_support_share((Phase(0.0, 1.0, both), Phase(1.0, 2.0, one), Phase(2.0, 3.0, both)), 0.2)
    assert [share(t) for t in (0.5, 1.0, 1.1, 1.3, 2.05, 2.5)] == pytest.approx([0.0, 0.0, 0.5, 1.0, 0.75, 0.0])


def test_no_shift_is_larger_than_its_reach_and_a_foot_in_the_air_is_no_measurement():
    damping = controller(0.72, reach=np.array([0.02, 0.02]))
    shifts = [damping(k * PERIOD, np.array([0.5, np.nan])) for k in range(100)]
    assert np.abs(shifts).max() <= 0.02
    assert np.all(np.isfinite(shifts))
