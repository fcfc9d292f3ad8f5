"""Balance: the divergent component's rate, the support polygon, the height."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

from sot.control.contact import Contact
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.polygon import Polygon
from sot.robots.robot import Robot, shipped_robot_names
from sot.robots.surface import Surface
from sot.static_region import Patch, static_region
from tasks import Balance
from tests.sot.states import random_state, standing_state

HEIGHT = 0.8
OMEGA = np.sqrt(GRAVITY / HEIGHT)


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def pendulum(t, com, velocity):
    """What the task asks of a tick, for a point mass in the air: its acceleration is the unknown itself."""
    tick = SimpleNamespace(t=t, com=com, com_velocity=velocity, contacts=(), momentum=np.zeros(6), mass=1.0)
    tick.com_jacobian, tick.com_drift = np.eye(3), np.zeros(3)
    return tick


def plan(t):
    """A pendulum's motion on the plane of HEIGHT, with the zero-moment point that makes it."""
    swing = np.array([0.05, 0.1, 0.0]) * np.sin([2.0 * t, 3.0 * t, 0.0])
    speed = np.array([0.1, 0.3, 0.0]) * np.cos([2.0 * t, 3.0 * t, 0.0])
    acceleration = -np.array([0.2, 0.9, 0.0]) * np.sin([2.0 * t, 3.0 * t, 0.0])
    com = swing + np.array([0.0, 0.0, HEIGHT])
    return com, speed, acceleration, com[:2] - acceleration[:2] / OMEGA**2


@pytest.mark.parametrize("k", [2.0, 4.0, 8.0])
def test_the_divergent_component_converges_at_the_rate_k(k):
    task, step = Balance(plan, k=k), 2e-4
    com, velocity, *_ = plan(0.0)
    com, velocity = com + np.array([0.02, -0.03, 0.0]), velocity + np.array([0.05, 0.02, 0.0])
    distances = []
    for i in range(round(0.8 / step)):
        wanted_com, wanted_velocity, *_ = plan(i * step)
        distances.append(((com - wanted_com) + (velocity - wanted_velocity) / OMEGA)[:2])
        acceleration = task.rows(pendulum(i * step, com, velocity)).lower
        com, velocity = com + step * velocity + 0.5 * step**2 * acceleration, velocity + step * acceleration
    times = step * np.arange(len(distances))
    expected = np.exp(-k * times)[:, None] * distances[0]
    np.testing.assert_allclose(distances, expected, atol=2e-3 * np.abs(distances[0]).min())


def test_on_the_plan_the_acceleration_is_the_plan_s():
    for t in (0.0, 0.3, 1.1):
        com, velocity, acceleration, _ = plan(t)
        rows = Balance(plan).rows(pendulum(t, com, velocity))
        np.testing.assert_allclose(rows.lower, acceleration, atol=1e-12)


def test_the_height_is_a_critically_damped_spring():
    com, velocity, acceleration, _ = plan(0.4)
    rows = Balance(plan, kp=64.0).rows(pendulum(0.4, com + np.array([0, 0, 0.01]), velocity + np.array([0, 0, -0.2])))
    assert rows.lower[2] == pytest.approx(acceleration[2] - 64.0 * 0.01 + 16.0 * 0.2)


def test_rows_are_those_of_the_centre_of_mass(robot):
    tick = Tick(robot).update(0.0, *random_state(robot, np.random.default_rng(0)))
    task = Balance(lambda t: (tick.com + np.array([0.01, 0.02, 0.03]), tick.com_velocity, np.zeros(3), tick.com[:2]))
    rows = task.rows(tick)
    np.testing.assert_array_equal(rows.A, tick.com_jacobian)
    np.testing.assert_array_equal(rows.lower, rows.upper)
    np.testing.assert_allclose(task.error, [0.01, 0.02, 0.03])


def commanded_pressure(tick, rows, reference):
    """The zero-moment point under which a pendulum of the tick's height accelerates as the rows want."""
    com, _, acceleration, pressure = reference(tick.t)
    wanted = (rows.lower + tick.com_drift)[:2]
    return pressure + (tick.com - com)[:2] - (wanted - acceleration[:2]) * tick.com[2] / GRAVITY


@pytest.mark.parametrize("standing", [("left_foot", "right_foot"), ("left_foot",), ("right_foot",)])
def test_no_pressure_is_asked_for_outside_what_the_feet_carry(robot, standing):
    rng, tick = np.random.default_rng(1), Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    for contact in tick.contacts:
        contact.load = 1.0 if contact.point in standing else 0.0
    inside = 0
    for _ in range(20):
        tick.update(0.0, *standing_state(robot, rng))
        offset = np.append(rng.uniform(-0.1, 0.1, 2), 0.0)
        still = np.zeros(3)

        def reference(t, offset=offset, still=still):
            return tick.com + offset, still, still, (tick.com + offset)[:2]

        rows = Balance(reference, margin=0.01).rows(tick)
        corners = [
            tick.frame(contact.point).position[:2] + contact.vertices[:, :2]
            for contact in tick.contacts
            if contact.point in standing
        ]
        polygon = Polygon.hull(np.concatenate(corners)).shrunk(0.01, 0.01)
        free = reference(0.0)[3] + (1.0 + 4.0 / np.sqrt(GRAVITY / tick.com[2])) * (
            -offset[:2] + tick.com_velocity[:2] / np.sqrt(GRAVITY / tick.com[2])
        )
        pressure = commanded_pressure(tick, rows, reference)
        assert polygon.margin(pressure) > -1e-9
        np.testing.assert_allclose(pressure, polygon.nearest_point(free), atol=1e-9)
        inside += polygon.margin(free) > 0.0
    assert inside < 20


@pytest.mark.parametrize("made", [False, True])
def test_with_a_hand_on_a_table_the_pressure_may_be_where_all_contacts_can_hold_the_body(robot, made):
    surfaces = [name for name in robot.surfaces if name not in robot.feet]
    if not surfaces:
        pytest.skip("no palms")
    tick = Tick(robot).update(0.0, robot.rest, np.zeros(robot.nv))
    palm = robot.surface(surfaces[0])
    place = tick.frame(palm.point).position
    square = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])
    hand = Contact(palm, Surface("table", square, pin.SE3(np.eye(3), place)), most=100.0)
    hand.mode, hand.load = ("fixed", 1.0) if made else ("off", 0.0)
    tick.contacts = [*(Contact(robot.surface(foot)) for foot in robot.feet), hand]
    far = tick.com - np.array([2.0, 0.0, 0.0])  # so that the pressure goes ahead as far as it may
    reference = lambda t: (far, np.zeros(3), np.zeros(3), far[:2])  # noqa: E731
    pressure = commanded_pressure(tick, Balance(reference, margin=0.0).rows(tick), reference)
    feet = np.vstack([tick.frame(c.point).floor_projection(c.vertices) for c in tick.contacts[:2]])
    patches = [
        Patch(
            tick.frame(c.point).position + c.vertices @ tick.frame(c.point).rotation.T,
            tick.relative_frame(c.surface, c.on).rotation,
            c.friction,
            c.most,
        )
        for c in tick.contacts[: 3 if made else 2]
    ]
    expected = static_region(patches, tick.mass * GRAVITY).vertices[:, 0].max() if made else feet[:, 0].max()
    assert pressure[0] == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("change", ["off", "sliding", "unloaded"])
def test_feet_that_do_not_carry_bound_nothing(robot, change):
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    for contact in tick.contacts:
        contact.mode, contact.load = (change, 1.0) if change != "unloaded" else ("fixed", 0.0)
    far = np.array([2.0, 0.0, 0.0])
    reference = lambda t: (tick.com - far, np.zeros(3), np.zeros(3), (tick.com - far)[:2])  # noqa: E731
    rows = Balance(reference).rows(tick)
    assert np.abs(commanded_pressure(tick, rows, reference)[0]) > 1.0


def test_the_polygon_follows_the_feet(robot):
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    task = Balance(
        lambda t: (tick.com + np.array([1.0, 0, 0]), np.zeros(3), np.zeros(3), tick.com[:2] + np.array([1.0, 0.0]))
    )
    q = robot.rest.copy()
    first = task.rows(tick.update(0.0, q, np.zeros(robot.nv))).lower.copy()
    q[0] += 0.3  # the whole robot, feet and all: nothing changes for it
    second = task.rows(tick.update(0.0, q, np.zeros(robot.nv))).lower
    np.testing.assert_allclose(second, first, atol=1e-9)


@pytest.mark.parametrize("crept", [(0.05, -0.02), (0.0, 0.0)])
def test_the_plan_goes_with_feet_that_have_crept(crept):
    robot = Robot.load("hrp2")
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    still = tick.frame("left_foot"), tick.frame("right_foot")
    com, z = tick.com.copy(), tick.com[:2].copy()
    planned = {foot: frame.position - np.array((*crept, 0.0)) for foot, frame in zip(robot.feet, still, strict=True)}
    nothing = np.zeros(3)

    def reference(t):
        return com - np.array((*crept, 0.0)), nothing, nothing, z - crept

    task = Balance(reference, feet={foot: lambda t, place=place: place for foot, place in planned.items()})
    rows = task.rows(tick)
    np.testing.assert_allclose(task.error, 0.0, atol=1e-12)
    np.testing.assert_allclose(rows.lower, -tick.com_drift, atol=1e-9)
    if any(crept):
        alone = Balance(reference)
        alone.rows(tick)
        np.testing.assert_allclose(alone.error[:2], np.negative(crept), atol=1e-12)


def test_a_foot_counts_as_much_as_it_may_carry():
    """While a foot that has landed beside its place takes its load, neither plan nor support jump."""
    robot = Robot.load("hrp2")
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    left, right = (tick.frame(foot).position.copy() for foot in robot.feet)
    beside, nothing = np.array([0.0, 0.02, 0.0]), np.zeros(3)
    over = np.array([0.0, right[1] - beside[1] - tick.com[1], 0.0])  # to its place for the right foot
    planned = {"left_foot": lambda t: left, "right_foot": lambda t: right - beside}
    errors, asked = [], []
    for load in np.linspace(0.0, 1.0, 101):
        tick.contacts[1].load = float(load)
        task = Balance(lambda t: (tick.com + over, nothing, nothing, (tick.com + over)[:2]), planned, k=0.0)
        asked.append(task.rows(tick).lower[1])
        errors.append(task.error[1] - over[1])
    assert (errors[0], errors[-1]) == (pytest.approx(0.0), pytest.approx(0.02))
    assert np.abs(np.diff(errors)).max() < 4e-4
    assert np.ptp(asked) > 0.5
    assert np.abs(np.diff(asked)).max() < 0.1 * np.ptp(asked)


def test_angular_momentum_is_given_up_where_it_leaves_too_little_room():
    """The plan has its zero-moment point near the edge for its spin; pushed over that edge, the pivot goes there."""
    robot = Robot.load("hrp2")
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    edge = max((tick.frame("left_foot").position + corner)[1] for corner in tick.contacts[0].vertices) - 0.001
    com, nothing = tick.com.copy(), np.zeros(3)
    spun = np.array([com[0], edge - 0.01])
    pull = GRAVITY / com[2]

    def asked(off: float) -> float:
        """Acceleration to the left that is asked for with the CoM that much too far to the left [m/s²]."""
        reference = lambda t: (com - (0.0, off, 0.0), nothing, nothing, spun)  # noqa: E731
        return float((Balance(reference).rows(tick).lower + tick.com_drift)[1])

    assert asked(0.0) == pytest.approx(0.0, abs=1e-9)
    assert asked(0.2) == pytest.approx(pull * (com[1] - edge), rel=0.02)  # as hard as if there were no spin
    steps = [asked(off) for off in np.linspace(0.0, 0.2, 401)]
    assert np.abs(np.diff(steps)).max() < 0.1


def test_without_height_it_asks_for_the_plane_alone():
    com, velocity, *_ = plan(0.3)
    tick = pendulum(0.3, com + np.array([0.02, -0.01, 0.05]), velocity)
    both, plane = Balance(plan), Balance(plan, axes="xy")
    rows, part = both.rows(tick), plane.rows(tick)
    np.testing.assert_array_equal(part.A, rows.A[:2])
    np.testing.assert_array_equal(part.lower, rows.lower[:2])
    np.testing.assert_array_equal(plane.error, both.error[:2])


def test_a_plan_goes_on_as_a_pendulum_s_motion_on_feet_that_stand_elsewhere():
    """Its zero-moment point over the left foot stays there; nothing is asked for but what the moved plan does."""
    robot = Robot.load("hrp2")
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    left, right = (tick.frame(foot).position.copy() for foot in robot.feet)
    planned = {"left_foot": lambda t: left - (0.1, 0.0, 0.0), "right_foot": lambda t: right}
    acceleration, height = np.array([0.1, -0.4, 0.0]), tick.com[2]
    z = left[:2] - (0.1, 0.0)
    com = np.append(z + height / GRAVITY * acceleration[:2], height)
    task = Balance(lambda t: (com, np.zeros(3), acceleration, z), planned)
    before = task.rows(tick).lower.copy()
    between = planned["right_foot"](0.0) - planned["left_foot"](0.0)
    tilt = np.outer(
        (-0.1, 0.0), between[:2] / (between[:2] @ between[:2])
    )  # less and less of it towards the right foot
    expected = np.append((0.1, 0.0) + tilt @ (com[:2] - z), 0.0)
    np.testing.assert_allclose(task.error + tick.com - com, expected, atol=1e-12)
    tick.com[:] = task.error + tick.com  # where the moved plan has it
    wanted = task.rows(tick).lower + tick.com_drift
    np.testing.assert_allclose(wanted[:2], acceleration[:2] + tilt @ acceleration[:2], atol=1e-9)
    assert not np.allclose(before[:2], (wanted - tick.com_drift)[:2])


def test_room_is_left_for_what_the_body_turns_too_much():
    """Pushed over the edge, and turning over it: the pivot is as far from the edge as stopping that takes."""
    robot = Robot.load("hrp2")
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    edge = max((tick.frame("left_foot").position + corner)[1] for corner in tick.contacts[0].vertices) - 0.001
    still, k = np.zeros(3), 4.0
    spin = np.array([-3.0, 0.0, 0.0])  # to the left
    rate = np.sqrt(GRAVITY / tick.com[2])

    def pivot(off: float, momentum: np.ndarray) -> float:
        reference = lambda t: (tick.com - (0.0, off, 0.0), still, still, tick.com[:2] - (0.0, off))  # noqa: E731
        rows = Balance(reference, momentum=lambda t: -momentum, k=k).rows(tick)  # the tick's own is none
        return float(tick.com[1] - (rows.lower + tick.com_drift)[1] * tick.com[2] / GRAVITY)

    room = (rate + k) * 3.0 / (robot.mass * GRAVITY)
    assert pivot(0.2, still) == pytest.approx(edge)
    assert pivot(0.2, spin) == pytest.approx(edge - room)
    assert pivot(0.02, spin) == pytest.approx(pivot(0.02, still))  # enough room as it is


def test_while_a_foot_catches_the_robot_the_zero_moment_point_is_what_is_commanded():
    """The rows hold for exactly those accelerations under which the floor's force and moment are at the point."""
    robot, rng = Robot.load("hrp2"), np.random.default_rng(3)
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot)) for foot in robot.feet]
    tick.contacts[1].mode, tick.contacts[1].is_catching = "off", True
    tick.update(0.0, *standing_state(robot, rng))
    reference = lambda t: (tick.com - (0.3, 0.0, 0.0), np.zeros(3), np.zeros(3), tick.com[:2] - (0.3, 0.0))  # noqa: E731
    rows = Balance(reference).rows(tick)
    acceleration = np.linalg.lstsq(rows.A, rows.lower, rcond=None)[0] + 0.0
    _, A, drift = tick.centroidal()
    force = A[:3] @ acceleration + drift[:3] + (0.0, 0.0, robot.mass * GRAVITY)
    moment = A[3:] @ acceleration + drift[3:]  # about the centre of mass
    x = tick.com[0] - (moment[1] + tick.com[2] * force[0]) / force[2]
    y = tick.com[1] + (moment[0] - tick.com[2] * force[1]) / force[2]
    sole = (tick.frame("left_foot").position + tick.contacts[0].vertices @ tick.frame("left_foot").rotation.T)[:, :2]
    assert Polygon.hull(sole).margin(np.array([x, y])) == pytest.approx(0.01, abs=1e-6)
    assert x > sole[:, 0].max() - 0.02
