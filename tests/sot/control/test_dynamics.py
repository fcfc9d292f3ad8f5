"""Level 0 and the two forms: what is decoded obeys the equation of motion, the contacts and the bounds."""

import numpy as np
import pytest

from solvers import Cascade, Status
from sot.control.dynamics import Dynamics
from sot.control.tick import Tick
from sot.robots.robot import Robot, shipped_robot_names
from tasks import CenterOfMass
from tests.sot.stances import standing_stack
from tests.sot.states import standing_state

FORMS = ("condensed", "full")


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def solve(robot, stack, form, q, v, solver=None):
    tick = Tick(robot)
    tick.contacts = stack.contacts
    tick.update(0.0, q, v)
    dynamics = Dynamics(robot, form)
    solution = (solver or Cascade()).solve(dynamics.assemble(tick, stack.contacts, stack.hard, stack.levels))
    return tick, solution, dynamics.decode(solution.x)


def shares(stack, decoded):
    """The forces of each contact."""
    return np.split(decoded.forces, np.cumsum([contact.force_count for contact in stack.contacts])[:-1])


def assert_obeys_level_0(robot, stack, tick, decoded):
    """Equation of motion, contact accelerations, friction and torque bounds, from the decoded words alone."""
    pushed = np.zeros(robot.nv)
    pushed[6:] = decoded.torque
    for contact, wrench, phi in zip(stack.contacts, decoded.wrenches, shares(stack, decoded), strict=True):
        frame = tick.frame(contact.point)
        pushed += frame.jacobian.T @ wrench
        held = list(contact.held_axes)
        acceleration = frame.jacobian @ decoded.acceleration + frame.drift
        np.testing.assert_allclose(acceleration[held], contact.acceleration(tick)[held], atol=1e-5)
        if len(phi):
            C, lower, upper = contact.force_inequalities(robot.mass * 9.81)
            assert np.all(C @ phi <= upper + 1e-3) and np.all(C @ phi >= lower - 1e-3)
            np.testing.assert_allclose(contact.force_equalities(tick) @ phi, 0.0, atol=1e-3)
        else:
            np.testing.assert_array_equal(wrench, 0.0)
    residual = tick.M @ decoded.acceleration + tick.h - pushed
    assert np.abs(residual).max() < 1e-6 * robot.mass * 9.81
    limits = stack.hard[0].rows(tick)
    assert np.all(decoded.torque <= limits.upper + 1e-4) and np.all(decoded.torque >= limits.lower - 1e-4)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("contact_form", ["pyramid", "unilateral"])
def test_the_answer_obeys_the_equation_of_motion_contacts_and_bounds(robot, form, contact_form):
    rng, solver = np.random.default_rng(0), Cascade()
    for _ in range(3):
        stack = standing_stack(robot, contact_form)
        tick, solution, decoded = solve(robot, stack, form, *standing_state(robot, rng), solver)
        assert solution.status <= Status.SECOND_SOLVER
        assert_obeys_level_0(robot, stack, tick, decoded)
        lost = tick.com_jacobian @ decoded.acceleration + tick.com_drift + [0.0, 0.0, 9.81]
        np.testing.assert_allclose(sum(decoded.wrenches)[:3], robot.mass * lost, atol=1e-2)  # Newton, as a whole


def test_at_rest_the_feet_carry_the_weight_and_nothing_accelerates(robot):
    q, v = robot.rest, np.zeros(robot.nv)
    _, _, decoded = solve(robot, standing_stack(robot), "condensed", q, v)
    np.testing.assert_allclose(decoded.acceleration, 0.0, atol=1e-4)
    np.testing.assert_allclose(sum(decoded.wrenches)[:3], [0.0, 0.0, robot.mass * 9.81], atol=1e-3)


@pytest.mark.parametrize("contact_form", ["pyramid", "unilateral"])
@pytest.mark.parametrize("fraction", [1.0, 0.2])
def test_full_and_condensed_are_equal(robot, contact_form, fraction):
    rng, bounded = np.random.default_rng(1), 0
    for _ in range(4):
        stack = standing_stack(robot, contact_form, fraction)
        q, v = standing_state(robot, rng)
        (_, one, condensed), (_, other, full) = (solve(robot, stack, form, q, v) for form in FORMS)
        assert max(one.status, other.status) <= Status.SECOND_SOLVER
        for mine, theirs in (
            (condensed.acceleration, full.acceleration),
            (condensed.torque, full.torque),
            (condensed.forces, full.forces),
            (np.concatenate(condensed.wrenches), np.concatenate(full.wrenches)),
        ):
            np.testing.assert_allclose(mine, theirs, atol=1e-6 * max(1.0, np.abs(theirs).max()))
        for level, twin in zip(one.levels[1:], other.levels[1:], strict=True):
            assert level.error == pytest.approx(twin.error, abs=1e-6 * (1.0 + twin.error)), level.name
        bounded += bool(np.any(np.abs(condensed.torque) > 0.999 * fraction * robot.effort))
    assert fraction == 1.0 or bounded >= 2, "the torque bounds did not bite"


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("contact_form", ["pyramid", "unilateral"])
@pytest.mark.parametrize("mode", ["off", "sliding"])
def test_one_foot_carries_when_the_other_does_not(robot, form, contact_form, mode):
    over = Tick(robot).frame("right_foot").position[:2].copy()
    stack = standing_stack(robot, contact_form, over=over)
    stack.contact("left_foot").mode = mode
    q = robot.rest.copy()
    tick, solution, decoded = solve(robot, stack, form, q, np.full(robot.nv, 0.01))
    assert solution.status <= Status.SECOND_SOLVER
    assert_obeys_level_0(robot, stack, tick, decoded)
    counts = [len(phi) for phi in shares(stack, decoded)]
    assert counts == [0 if mode == "off" else 4, 12 if contact_form == "pyramid" else 10]
    assert decoded.wrenches[1][2] > 0.3 * robot.mass * 9.81


def test_in_the_air_the_centre_of_mass_falls(robot):
    stack = standing_stack(robot)
    for contact in stack.contacts:
        contact.mode = "off"
    for form in FORMS:
        tick, solution, decoded = solve(robot, stack, form, robot.rest, np.zeros(robot.nv))
        assert solution.status <= Status.SECOND_SOLVER
        fall = tick.com_jacobian @ decoded.acceleration + tick.com_drift
        np.testing.assert_allclose(fall, [0.0, 0.0, -9.81], atol=1e-4)


def test_an_impossible_level_0_names_what_gave_way(robot):
    stack = standing_stack(robot, fraction=0.05)
    stack.hard.append(CenterOfMass(Tick(robot).com.copy()))  # without it the robot may well collapse
    tick, solution, decoded = solve(robot, stack, "condensed", robot.rest, np.zeros(robot.nv))
    assert solution.status == Status.RELAXED
    limit = 0.05 * robot.effort
    excess = np.max(np.abs(decoded.torque) - limit)
    assert set(solution.relaxed) == {"TorqueBounds"}
    assert solution.relaxed["TorqueBounds"] == pytest.approx(excess, rel=1e-3)  # in newton metres
    residual = tick.M @ decoded.acceleration + tick.h
    residual[6:] -= decoded.torque
    for contact, wrench in zip(stack.contacts, decoded.wrenches, strict=True):
        residual -= tick.frame(contact.point).jacobian.T @ wrench
    assert np.abs(residual).max() < 1e-3


@pytest.mark.parametrize("contact_form", ["pyramid", "unilateral"])
def test_every_row_has_an_owner_and_a_violation_in_its_owner_s_unit(robot, contact_form):
    stack = standing_stack(robot, contact_form)
    tick = Tick(robot)
    tick.contacts = stack.contacts
    dynamics = Dynamics(robot, "full")
    levels = dynamics.assemble(tick, stack.contacts, stack.hard, stack.levels)
    for level in levels:
        for equality, count in ((True, len(level.b)), (False, len(level.lower))):
            owned = [block for block in level.blocks if block.equality is equality]
            assert sum(block.rows.stop - block.rows.start for block in owned) == count
            assert [block.rows.start for block in owned] == [0, *(block.rows.stop for block in owned)][: len(owned)]
    hard, x = levels[0], np.random.default_rng(0).normal(size=levels[0].A.shape[1])
    decoded, violation = dynamics.decode(x), levels[0].A @ x - levels[0].b
    by_name = {block.name: violation[block.rows] / block.weight for block in hard.blocks if block.equality}
    wrenches = sum(tick.frame(c.point).jacobian.T @ w for c, w in zip(stack.contacts, decoded.wrenches, strict=True))
    missing = tick.M @ decoded.acceleration + tick.h - wrenches
    np.testing.assert_allclose(by_name["Dynamics"][:6], missing[:6], rtol=1e-9, atol=1e-6)
    if contact_form == "unilateral":
        pressure = np.concatenate([value for name, value in by_name.items() if name.startswith("Pressure")])
        parts = zip(stack.contacts, shares(stack, decoded), strict=True)
        expected = np.concatenate([contact.force_equalities(tick) @ phi for contact, phi in parts])
        np.testing.assert_allclose(pressure, expected, rtol=1e-9, atol=1e-9)
