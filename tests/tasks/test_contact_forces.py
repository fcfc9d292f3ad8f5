"""Least forces: the load shared evenly, and a last level with one answer only."""

import numpy as np
import pytest

from solvers import Cascade
from sot.control.contact import Contact
from sot.control.controller import Controller
from sot.control.dynamics import Dynamics
from sot.control.tick import Tick
from sot.robots.robot import Robot, shipped_robot_names
from tasks import LeastForces
from tests.sot.stances import leaning, standing_stack


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


@pytest.mark.parametrize("form", ["pyramid", "unilateral"])
def test_rows_cover_the_force_variables_of_the_present_modes(robot, form):
    tick, each = Tick(robot), 12 if form == "pyramid" else 10
    tick.contacts = [Contact(robot.surface(foot), form=form) for foot in robot.feet]
    for mode, count in (("fixed", 2 * each), ("sliding", each + 4), ("off", each)):
        tick.contacts[0].mode = mode
        rows = LeastForces().rows(tick)
        np.testing.assert_array_equal(rows.A, np.eye(count))
        np.testing.assert_array_equal(rows.lower, np.zeros(count))
        np.testing.assert_array_equal(rows.upper, np.zeros(count))


def test_what_is_in_reserve_is_leaned_on_less(robot):
    """With one foot's forces k times as dear, the load is what weighted least squares give."""
    q, shares = leaning(robot, 0.5), []
    for reserve in (1.0, 4.0):
        stack = standing_stack(robot, at=q)
        stack.contacts[0].reserve = reserve
        command = Controller(robot, stack, Cascade())(0.0, q, np.zeros(robot.nv))
        shares.append(command.wrenches[0][2] / command.wrenches[:, 2].sum())
    assert shares[0] == pytest.approx(0.5, abs=1e-3) and shares[1] < 0.45


def test_standing_in_the_middle_both_feet_and_no_squeezing(robot):
    q = leaning(robot, 0.5)
    command = Controller(robot, standing_stack(robot, at=q), Cascade())(0.0, q, np.zeros(robot.nv))
    left, right = command.wrenches
    assert left[2] == pytest.approx(right[2], rel=1e-3)
    np.testing.assert_allclose([left[:2], right[:2]], 0.0, atol=0.05)


def test_the_load_is_shared_as_least_squares_would(robot):
    """At rest, with no friction or pressure bound met: φ is the pseudo-inverse's share of weight and moments."""
    q = leaning(robot, 0.5)
    stack, tick = standing_stack(robot, at=q), Tick(robot)
    tick.contacts = stack.contacts
    tick.update(0.0, q, np.zeros(robot.nv))
    dynamics = Dynamics(robot)
    levels = dynamics.assemble(tick, stack.contacts, stack.hard, stack.levels)
    forces = dynamics.decode(Cascade().solve(levels).x).forces
    on_base = np.hstack([(tick.frame(c.point).jacobian.T @ c.wrench_map(tick))[:6] for c in stack.contacts])
    expected = np.linalg.pinv(on_base) @ tick.h[:6]
    assert expected[2::3].min() > 0.0
    np.testing.assert_allclose(forces, expected, atol=1e-3)
