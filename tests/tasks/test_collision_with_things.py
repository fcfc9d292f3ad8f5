"""Robot, box and table keep apart: distances against coal's own, Jacobians and differences, an arm before a table."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios.stacks import planted_stack
from sim import World
from solvers import Cascade
from sot.control import Contact, Controller
from sot.control.tick import Tick
from sot.motion import Motion
from sot.proximity import Proximity
from sot.robots import Robot, System, Thing
from tasks import OperationalPoint, SelfCollision, TorqueRateBounds
from tasks.self_collision import _write_lower_bounds


@pytest.fixture(scope="module")
def system():
    robot = Robot.load("hrp2")
    table = Thing.load("table", placement=(0.75, 0.0, 0.0))
    return System(
        robot, [Thing.load("box", placement=(0.5, 0.0, 0.85)), table, Thing.load("door", placement=(0.9, 0.9, 0))]
    )


def near_state(system, seed):
    rng = np.random.default_rng(seed)
    return pin.integrate(system.model, system.rest, rng.uniform(-0.2, 0.2, system.nv)), rng.uniform(-1, 1, system.nv)


def test_pairs_are_the_robots_own_and_those_with_things(system):
    own, pairs = Proximity(system.robot).pairs, Proximity(system).pairs
    assert pairs[: len(own)] == own
    others = {frozenset(name.split("/")[0] if "/" in name else "robot" for name in pair) for pair in pairs[len(own) :]}
    named = {frozenset(pair) for pair in (("robot", "box"), ("robot", "table"), ("robot", "door"))}
    assert others == named | {frozenset(pair) for pair in (("box", "table"), ("box", "door"), ("table", "door"))}


def test_what_is_near_is_found_wherever_it_moved(system):
    proximity, everything, tick = Proximity(system), Proximity(system), Tick(system)
    within = np.full(len(proximity.pairs), 0.1)
    for seed in range(6):
        tick.update(0.0, *near_state(system, seed))
        for each in (proximity, everything):
            each.move_to(tick.data)
        found = proximity.pairs_within(within)
        every = everything.measure(np.arange(len(within)))
        assert found.tolist() == np.flatnonzero(every < 0.1).tolist()


def test_jacobians_are_derivatives(system):
    task, tick, (q, v), step = SelfCollision(system), Tick(system), near_state(system, 2), 1e-6
    pairs = np.array([k for k, names in enumerate(task.pairs) if any("/" in name for name in names)])
    tick.update(0.0, q, v)
    distances, rates, *_ = task.motion(tick, pairs)
    apart = distances > 0.01  # overlapping boxes have no smooth distance
    ends = []
    for sign in (1.0, -1.0):
        tick.update(0.0, pin.integrate(system.model, q, sign * step * v), v)
        ends.append(task.motion(tick, pairs)[0])
    by_differences = (ends[0] - ends[1]) / (2.0 * step)
    assert apart.sum() > 20
    np.testing.assert_allclose(rates[apart], by_differences[apart], atol=1e-3)


def test_only_what_is_carried_keeps_off_things_unless_a_contact_brings_them_together(system):
    task, tick = SelfCollision(system), Tick(system)
    q = system.rest.copy()
    q[system.coordinates["box"]][:3] = 0.6, 0.0, 0.805

    def kept_apart(t):
        task.rows(tick.update(t, q, np.zeros(system.nv)))
        return any({"box/box", "table/block"} == set(label.split(" and ")) for label in task.labels)

    assert not kept_apart(0.0)
    tick.carried = ("box",)
    assert kept_apart(1.0)
    tick.contacts = [Contact(system.surface("box/bottom"), system.surface("table/top"))]
    assert not kept_apart(2.0)


@pytest.mark.parametrize("knows", [True, False])
def test_an_arm_stops_before_a_table(knows):
    """A hand that is sent through a table's side: in physics, with and without the table in the task. It turns until
    two corners are as near, and no torque steps by that; rates of torques are not limited."""
    robot, period = Robot.load("hrp2"), 0.002
    motion = Motion.standing(robot, 2.0, 1.0 / period)
    start = motion.pose("right_hand")(0.0).position
    table = Thing.load("table", placement=(start[0] + 0.25, start[1], 0.0), size=(0.3, 0.2, 0.8))
    stack, world = planted_stack(robot, motion), World(robot, period, things=[table])
    stack.hard[:] = [limit for limit in stack.hard if not isinstance(limit, TorqueRateBounds)]
    if knows:
        stack.hard[:] = [limit for limit in stack.hard if not isinstance(limit, SelfCollision)]
        stack.hard.append(SelfCollision(System(robot, [table])))
    controller = Controller(robot, stack, Cascade(), period)
    there = start + np.array([0.15, 0.0, 0.0])
    stack.add(OperationalPoint(robot, "right_hand", there, axes="xyz", kp=9.0, weight=50.0, name="hand"), "posture")
    pressed, ahead, torques = [], [], []
    for k in range(500):
        torques.append(controller(k * period, *world.state()).torque.copy())
        world.step(torques[-1])
        pressed.append(sum(touch.normal for pair, touch in world.touches().items() if "table" in pair))
        ahead.append(controller.tick.frame("right_hand").position[0] - start[0])
    assert max(ahead) > 0.03
    assert (max(pressed) < 1.0) == knows
    if knows:
        assert np.abs(np.diff(torques[10:], axis=0)).max() < 50.0


def test_what_is_pushed_slowly_at_a_thing_is_braked_in_proportion(system):
    """A distance with the least acceleration that its row allows, pushed on all the time: no kick where it is stopped,
    for a pair with a thing; the robot's own pairs are stopped with all that is relied upon."""
    task, period, greatest = SelfCollision(system), 0.002, {}
    own, with_thing = 0, len(Proximity(system.robot).pairs)
    J = np.ones((1, system.nv))
    for pair in (own, with_thing):
        kept, gap, rate, asked = task.min_distances[pair], 0.005, -0.03, []
        for _ in range(400):
            lower = np.empty(1)
            state = np.array([kept + gap]), np.array([rate]), J, np.zeros(1), np.array([pair])
            limits = task.min_distances, np.arange(len(task.pairs)) >= with_thing, task._soft
            _write_lower_bounds(*state, *limits, np.full(system.robot.na, 60.0), period, lower)
            asked.append(max(lower[0], -2.0))
            gap, rate = gap + period * rate + 0.5 * period**2 * asked[-1], rate + period * asked[-1]
            assert gap > -1e-5
        assert gap < 1e-3  # it gets there
        greatest[pair] = max(asked)
    assert greatest[with_thing] < 4.0 and greatest[own] > 10.0
