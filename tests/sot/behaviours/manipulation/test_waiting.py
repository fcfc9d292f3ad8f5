"""Steps that wait until the robot is ready."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sot.behaviours.manipulation.pace import COM_REST_SPEED, MAX_WAIT
from sot.behaviours.manipulation.waiting import GivenUpError, WaitingSchedule
from sot.robots.robot import Robot

PERIOD = 0.01


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


class Steps(WaitingSchedule):
    """Leads the centre of mass ahead and waits for it; after a failure it notes that it retreats."""

    retreats = 0
    failing = False

    def phases(self) -> Iterator[None]:
        self.lead_com(np.array([0.05, 0.0]))
        yield from self.settled_com("a step")

    def retreat(self) -> Iterator[None]:
        self.retreats += 1
        yield
        if self.failing:
            raise GivenUpError("twice")


def _run(steps: Steps, com: np.ndarray, velocity: float, until: float) -> Any:
    """A robot whose centre of mass is at a place with a velocity, whatever it is told."""
    stack: Any = SimpleNamespace(carried=[], advance=lambda t: None)
    for t in np.arange(0.0, until, PERIOD).tolist():
        steps.apply(t, stack)
        steps.observe(SimpleNamespace(t=t, com=np.append(com, 0.8), com_velocity=np.array([velocity, 0.0, 0.0])))  # type: ignore[arg-type]
    return stack


def test_a_centre_of_mass_has_arrived_when_it_is_there_at_rest(robot: Robot) -> None:
    steps = Steps(robot, np.zeros(2), 1.0)
    _run(steps, np.array([0.05, 0.0]), 0.0, 3.0)
    assert steps.finished and not steps.failure and not steps.retreats
    restless = Steps(robot, np.zeros(2), 1.0)
    _run(restless, np.array([0.05, 0.0]), 2.0 * COM_REST_SPEED * restless.leg / restless.unit, 3.0)
    assert not restless.finished


@pytest.mark.parametrize("failing", [False, True])
def test_what_does_not_arrive_is_given_up_and_said_once(robot: Robot, failing: bool) -> None:
    steps = Steps(robot, np.zeros(2), 1.0)
    steps.failing = failing
    _run(steps, np.zeros(2), 0.0, (MAX_WAIT + 2.0) * steps.unit)
    assert steps.finished and steps.retreats == 1
    assert steps.failure.startswith("a step: the centre of mass is 50 mm off its goal after")


def test_the_led_centre_of_mass_changes_its_owner_at_the_next_state(robot: Robot) -> None:
    steps = Steps(robot, np.zeros(2), 1.0)
    steps.carried = ("box",)
    stack = _run(steps, np.array([0.02, 0.01]), 0.0, 3.5 * PERIOD)
    assert stack.carried == ["box"]
    np.testing.assert_allclose(steps.com(2.0 * PERIOD)[0][:2], [0.02, 0.01], atol=2e-3)
