"""A box carried on the robot's own steps."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios.otani2017.carrying import carry as study
from scenarios.otani2017.carrying.scene import BOX, GOAL, START, carry_demonstration, carry_things
from scenarios.otani2017.carrying.stack import carry_stack
from scenarios.otani2017.handling_stack import contacts_of
from scenarios.otani2017.scene import ObjectOptions
from scenarios.replay import Replay
from sot.behaviours.manipulation.walking import WalkingManipulation
from sot.motion.carrying.arms import palm_places
from sot.motion.carrying.carry import CarryPlan
from sot.motion.objects.retarget import RobotDemonstration
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.system import System


def _plan(robot: Robot) -> CarryPlan:
    """A box that is lifted by 0.1 m before a robot that stands."""
    motion, knots = Motion.standing(robot, 6.0, 100.0), 0.1 * np.arange(61)
    rise = 0.1 * np.clip(knots - 2.0, 0.0, 1.0) - 0.1 * np.clip(knots - 4.0, 0.0, 1.0)
    box = [pin.SE3(np.eye(3), np.array([0.35, 0.0, 0.75 + up])) for up in rise.tolist()]
    size = (0.2, 0.34, 0.2)
    return CarryPlan(motion, box, knots, 1.5, 2.0, 4.0, 5.0, 5.5, palm_places(robot, size[1], 0.3), size)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture
def demonstration(robot: Robot) -> RobotDemonstration:
    plan = _plan(robot)
    return carry_demonstration(plan, System(robot, carry_things(plan, ObjectOptions(2.0))))


def test_stands_carry_the_box_where_it_is_taken_and_set_down(robot: Robot) -> None:
    things = {thing.name: thing for thing in carry_things(_plan(robot), ObjectOptions(2.0))}
    assert set(things) == {START, GOAL, BOX}
    assert things[BOX].mass == pytest.approx(2.0)
    for stand in (START, GOAL):
        assert things[stand].surface("top").placement.translation[2] == pytest.approx(0.65)


def test_the_box_is_led_to_above_the_stand_and_hands_to_its_sides(demonstration: RobotDemonstration) -> None:
    sets = demonstration.contacts.sets_after(3, ())
    assert sets.holding == {"left_hand", "right_hand"} and sets.supports == {"left_foot", "right_foot"}
    path = demonstration.things[BOX]
    assert path.placement(3.5).translation[2] == pytest.approx(0.85, abs=1e-3)
    assert path.placement(5.0).translation[2] > 0.75 + 0.02
    made = {event: target for event, target in demonstration.targets.items() if target.body == BOX}
    assert {target.mover for target in made.values()} == {"left_hand", "right_hand"}


def test_the_balance_that_is_led_is_the_motions_while_its_clock_runs(demonstration: RobotDemonstration) -> None:
    contacts = contacts_of(demonstration)
    schedule = WalkingManipulation(demonstration, contacts)
    stack = carry_stack(demonstration, contacts, schedule)
    schedule.apply(0.0, stack, {})
    com, velocity, acceleration, zmp = schedule.balance(0.0)
    wanted = demonstration.motion.balance(0.0)
    np.testing.assert_allclose(com, wanted[0], atol=1e-9)
    np.testing.assert_allclose(zmp, wanted[3], atol=1e-9)
    assert not velocity.any() and not acceleration.any()
    assert [contact.mode for contact in contacts.values()] == ["fixed", "fixed", "fixed", "off", "off", "off"]


@pytest.mark.slow
def test_a_box_is_carried_around_a_corner(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "BACK_LEGS", 0.6)
    monkeypatch.setattr(study, "AHEAD_LEGS", 0.7)
    done = study.perform(Replay("", "hrp2", rate=500.0), study.Carrying(), lambda what, share: None)
    figures = study.carry_figures(done)
    assert done.danced.run.fell_at_s is None and not done.schedule.failure
    assert figures["carrying"]["off_way_max_m"] < 0.01
    assert figures["objects"][BOX]["end_error_m"] < 0.005
    assert figures["objects"][BOX]["end_tilt_deg"] < 1.0
