"""Contacts follow the phases of a motion, and what the feet feel overrules the clock where it should."""

import pytest

from sot.behaviours.stepping import MAX_LANDING_DELAY, SteppingSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.motion.feet.contacts import Phase, planted_phases
from sot.robots.robot import Robot

LEFT, RIGHT = "left_foot", "right_foot"
RISE, LIFT, LAND = 0.4, 0.5, 1.0
PERIOD = 0.002


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture
def stack(robot: Robot) -> Stack:
    return Stack([Contact(robot.surface(foot)) for foot in robot.feet], [], {})


@pytest.fixture
def stepping(robot: Robot) -> SteppingSchedule:
    """The right foot is in the air between LIFT and LAND."""
    both = planted_phases(robot, 0.0)[0].feet
    alone = {LEFT: both[LEFT]}
    return SteppingSchedule(robot, [Phase(0.0, LIFT, both), Phase(LIFT, LAND, alone), Phase(LAND, 2.0, both)])


def modes(stepping, stack, loads=None, until=2.0):
    """When each contact changed, and the right foot's load over time."""
    changes, ramp = [], {}
    for k in range(round(until / PERIOD)):
        t = k * PERIOD
        now = loads(t) if loads else None
        changes += [(round(t, 3), change) for change in stepping.apply(t, stack, now)]
        ramp[round(t, 3)] = stack.contact(RIGHT).load
    return changes, ramp


def carried(robot, left, right):
    return {LEFT: left * robot.mass * 9.81, RIGHT: right * robot.mass * 9.81}


def test_without_sensors_all_happens_as_planned(stepping, stack):
    changes, ramp = modes(stepping, stack)
    assert changes == [(LIFT, f"{RIGHT} off"), (LAND, f"{RIGHT} fixed")]
    assert ramp[0.0] == 1.0
    assert ramp[0.46] == pytest.approx(1.0)
    assert ramp[0.48] == pytest.approx(0.5)
    assert ramp[0.498] == pytest.approx(0.05)
    assert ramp[0.5] == ramp[1.0] == 0.0
    assert ramp[1.02] == pytest.approx(0.5)
    assert ramp[1.04] == pytest.approx(1.0)
    assert stack.contact(LEFT).load == 1.0


def test_feet_that_feel_what_is_planned_change_nothing(robot, stepping, stack):
    changes, _ = modes(stepping, stack, lambda t: carried(robot, 0.9, 0.1 if t < LIFT or t >= LAND else 0.0))
    assert changes == [(LIFT, f"{RIGHT} off"), (LAND, f"{RIGHT} fixed")]


def test_a_foot_that_touches_early_has_landed_but_not_while_it_leaves(robot, stepping, stack):
    changes, ramp = modes(stepping, stack, lambda t: carried(robot, 0.8, 0.2 if t < 0.6 or t > 0.9 else 0.0))
    assert changes == [(LIFT, f"{RIGHT} off"), (0.902, f"{RIGHT} fixed")]
    assert ramp[0.922] == pytest.approx(0.5)


def test_a_foot_looks_for_the_floor_a_little_longer(robot, stepping, stack):
    changes, _ = modes(stepping, stack, lambda t: carried(robot, 1.0, 0.0 if t < 1.08 else 0.2))
    assert changes[1] == (1.08, f"{RIGHT} fixed")


def test_but_not_for_ever(robot, stepping, stack):
    changes, _ = modes(stepping, stack, lambda t: carried(robot, 1.0, 0.0))
    assert changes[1] == (pytest.approx(LAND + MAX_LANDING_DELAY, abs=PERIOD), f"{RIGHT} fixed")


def test_no_foot_is_released_before_the_other_carries(robot, stepping, stack):
    changes, ramp = modes(stepping, stack, lambda t: carried(robot, *((0.1, 0.9) if t < 0.6 else (1.0, 0.0))))
    assert changes[0] == (pytest.approx(0.64, abs=PERIOD), f"{RIGHT} off")
    assert ramp[0.6] == 1.0


def test_a_step_for_which_it_is_too_late_is_left_out(robot, stepping, stack):
    changes, ramp = modes(stepping, stack, lambda t: carried(robot, 0.1, 0.9))
    assert changes == []
    assert set(ramp.values()) == {1.0}


def rolling_until(stepping, stack, until, loads=None):
    """When the right foot rolls, first and last."""
    found = []
    for k in range(round(until / PERIOD)):
        stepping.apply(k * PERIOD, stack, loads(k * PERIOD) if loads else None)
        if stack.contact(RIGHT).is_rolling:
            found.append(round(k * PERIOD, 3))
    return found[0], found[-1]


@pytest.mark.parametrize(("carries_from", "rises"), [(0.0, RISE), (0.45, 0.45)])
def test_a_heel_rises_when_it_is_time_and_another_foot_carries(robot, stack, carries_from, rises):
    both = planted_phases(robot, 0.0)[0].feet
    phases = [
        Phase(0.0, RISE, both),
        Phase(RISE, LIFT, both, rising=(RIGHT,)),
        Phase(LIFT, LAND, {LEFT: both[LEFT]}),
        Phase(LAND, 2.0, both),
    ]
    stepping = SteppingSchedule(robot, phases, heel_paths={RIGHT: lambda t: None})

    def loads(t):
        return carried(robot, 0.5 if t >= carries_from else 0.1, 0.5 if t < LIFT or t >= LAND else 0.0)

    assert rolling_until(stepping, stack, 2.0, loads) == (rises, LIFT - PERIOD)
    assert stack.contact(RIGHT).mode == "fixed" and len(stack.contact(RIGHT).vertices) == 4


def test_planted_feet_stay(robot, stack):
    changes, ramp = modes(SteppingSchedule(robot, planted_phases(robot, 2.0)), stack)
    assert changes == []
    assert set(ramp.values()) == {1.0}


def test_a_step_that_was_not_planned(robot, stack):
    stepping = SteppingSchedule(robot, planted_phases(robot, 2.0))
    assert (stepping.stances_begun(RIGHT), stepping.stances_to_come(RIGHT)) == (1, 0)
    stepping.apply(0.2, stack)
    stepping.add_step(RIGHT, LIFT, LAND)
    assert (stepping.stances_begun(RIGHT), stepping.stances_to_come(RIGHT), stepping.stances_to_come(LEFT)) == (1, 1, 0)
    changes, _ = modes(stepping, stack)
    assert changes == [(LIFT, f"{RIGHT} off"), (LAND, f"{RIGHT} fixed")]
    assert (stepping.stances_begun(RIGHT), stepping.stances_to_come(RIGHT)) == (2, 0)


def test_who_carries(robot, stepping, stack):
    assert stepping.others_carry(RIGHT, stack, None)
    assert stepping.others_carry(RIGHT, stack, carried(robot, 0.4, 0.6))
    assert not stepping.others_carry(RIGHT, stack, carried(robot, 0.2, 0.8))
    stack.contact(LEFT).mode = "off"
    assert not stepping.others_carry(RIGHT, stack, carried(robot, 1.0, 0.0))
