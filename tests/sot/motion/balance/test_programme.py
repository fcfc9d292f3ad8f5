import numpy as np
import pinocchio as pin
import pytest

from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.programme import plan_balance
from sot.motion.body.coordinates import from_configuration, to_pinocchio
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import Phase, phase_indices, planted_phases, support_polygon
from sot.motion.feet.support import Support, zmp_inset
from sot.robots.robot import Robot

PERIOD = 0.02


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def dance(robot):
    """A wild motion of all joints about the rest posture, whose ZMP leaves the soles."""
    t = PERIOD * np.arange(200)
    rates = np.linspace(3.0, 7.0, robot.nv)
    y = (
        from_configuration(robot.rest[None])
        + 0.15 * np.sin(np.outer(t, rates)) * np.sin(np.pi * t / t[-1])[:, None] ** 2
    )
    spline = Spline.through(y, PERIOD)
    return to_pinocchio(spline.knots, spline.velocities, spline.accelerations)


def test_zmp_is_where_the_floor_must_push(robot, dance):
    zmp = Centroidal.along(robot, *dance).zmp()
    data = robot.model.createData()
    for k in range(0, len(zmp), 7):
        pin.forwardKinematics(robot.model, data, dance[0][k])
        base = pin.Force(pin.rnea(robot.model, data, *(part[k] for part in dance))[:6])
        floor = data.oMi[1].act(base)
        expected = [-floor.angular[1] / floor.linear[2], floor.angular[0] / floor.linear[2]]
        np.testing.assert_allclose(zmp[k], expected, atol=1e-9)


def test_plan_keeps_the_zmp_inside_and_ends_at_rest_over_the_middle(robot, dance):
    motion = Centroidal.along(robot, *dance)
    phases = planted_phases(robot, 4.0)
    polygon = support_polygon(robot, phases[0])
    assert polygon.margin(motion.zmp()).min() < 0.0
    plan = plan_balance(
        motion, motion.com[:, :2], [Support(0.0, polygon, polygon.shrunk(*zmp_inset(robot, phases[0])))], PERIOD
    )
    assert plan.excursion < 1e-5
    assert polygon.shrunk(*zmp_inset(robot, phases[0])).margin(plan.zmp).min() > -1e-5
    height, offset = motion.pendulum()
    np.testing.assert_allclose(plan.zmp, plan.com.knots - height[:, None] * plan.com.accelerations + offset)
    np.testing.assert_allclose(plan.com.knots[0], motion.com[0, :2], atol=1e-5)
    np.testing.assert_allclose(plan.com.knots[-1], polygon.centre, atol=1e-5)
    for end in (0, -1):
        np.testing.assert_allclose(plan.com.velocities[end], 0.0, atol=1e-3)


def test_plan_leaves_the_inset_only_where_it_must(robot):
    """A turning moment at the very start, where the CoM is still held at rest."""
    length = 150
    com = np.tile([0.02, 0.0, 0.8], (length, 1))
    rate = np.zeros((length, 6))
    rate[:3, 4] = 400.0
    motion = Centroidal(com, np.zeros((length, 6)), rate, robot.mass)
    phases = planted_phases(robot, length * PERIOD)
    polygon = support_polygon(robot, phases[0])
    plan = plan_balance(
        motion, com[:, :2], [Support(0.0, polygon, polygon.shrunk(*zmp_inset(robot, phases[0])))], PERIOD
    )
    outside = polygon.shrunk(*zmp_inset(robot, phases[0])).margin(plan.zmp) < -1e-5
    assert plan.excursion > 0.01
    assert outside[0] and not outside[10:].any()


def test_support_of_the_soles(robot):
    phases = planted_phases(robot, 1.0)
    polygon = support_polygon(robot, phases[0])
    corners = np.vstack([[pose.act(c)[:2] for c in robot.sole(foot)] for foot, pose in phases[0].feet.items()])
    assert polygon.margin(corners).min() == pytest.approx(0.0, abs=1e-9)
    assert polygon.margin(polygon.centre[None])[0] > 0.05
    assert polygon.margin(np.array([[1.0, 0.0]]))[0] < -0.8
    middle = polygon.centre[None]
    assert polygon.shrunk(0.02, 0.02).margin(middle)[0] == pytest.approx(polygon.margin(middle)[0] - 0.02)


def test_phase_of_a_time(robot):
    first = planted_phases(robot, 1.0)[0]
    second = Phase(1.0, 2.0, first.feet)
    np.testing.assert_array_equal(phase_indices([first, second], np.array([-1.0, 0.5, 1.0, 3.0])), [0, 0, 1, 1])
