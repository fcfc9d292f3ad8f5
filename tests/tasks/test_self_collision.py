"""Self-collision: what its rows say by finite differences, what they keep, and that they do so under physics."""

import numpy as np
import pinocchio as pin
import pytest

from sim.world import World
from solvers import Cascade
from sot.control.controller import Controller
from sot.control.tick import Tick
from sot.proximity import Proximity
from sot.robots.robot import Robot, shipped_robot_names
from tasks import Posture, SelfCollision
from tasks.self_collision import LOOK_PERIOD, SPEED_CHANGE_BOUND
from tests.sot.stances import standing_stack
from tests.sot.states import random_state


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def smooth(task, tick, q, v, pairs, step):
    """Pairs whose nearest points do not jump on the way from one step before to one after."""
    rates = []
    for sign in (-1.0, -0.5, 0.0, 0.5, 1.0):
        _, rate, _, _ = task.motion(tick.update(0.0, pin.integrate(tick.robot.model, q, sign * step * v), v), pairs)
        rates.append(rate)
    return np.abs(np.diff(rates, n=2, axis=0)).max(axis=0) < 1e-6


def test_jacobian_and_drift_against_finite_differences(robot):
    task, rng, step = SelfCollision(robot), np.random.default_rng(0), 1e-4
    tick, pairs = Tick(robot, period=1e-5), np.arange(len(task.pairs))
    compared = 0
    for _ in range(20):
        q, v = random_state(robot, rng)
        distances, rates, J, drift = (part.copy() for part in task.motion(tick.update(0.0, q, v), pairs))
        np.testing.assert_allclose(rates, J @ v, atol=1e-12)

        def at(time, q=q, v=v):
            return task.motion(tick.update(0.0, pin.integrate(robot.model, q, time * v), v), pairs)[:2]

        (after, rates_after), (before, rates_before) = at(step), at(-step)
        keep = (distances > 0.01) & smooth(task, tick, q, v, pairs, step)
        np.testing.assert_allclose(rates[keep], ((after - before) / (2 * step))[keep], atol=2e-4)
        np.testing.assert_allclose(drift[keep], ((rates_after - rates_before) / (2 * step))[keep], atol=0.05)
        compared += np.count_nonzero(keep)
    assert compared > 500


def crossed(robot):
    """The rest posture with the right forearm and hand laid through the waist."""
    q = robot.rest.copy()
    for name, angle in (("RARM0", 0.76), ("RARM1", 0.05), ("RARM2", 0.96), ("RARM3", -1.43)):
        q[7 + robot.joints.index(name)] = angle
    return q


def least(task, tick):
    return float(task.motion(tick, np.arange(len(task.pairs)))[0].min())


@pytest.mark.parametrize("period", [0.001, 0.005])
def test_an_arm_that_is_to_cross_the_waist_stops_before_it(robot, period):
    """Joints that accelerate as a posture wants, as far as the task's rows let them."""
    task, posture, tick = (
        SelfCollision(robot, min_distance=0.01),
        Posture(robot, crossed(robot)[7:], kp=200.0),
        Tick(robot, period),
    )
    q, v = robot.rest.copy(), np.zeros(robot.nv)
    nearest = np.inf
    for k in range(round(1.5 / period)):
        tick.update(k * period, q, v)
        nearest = min(nearest, least(task, tick))
        wanted = np.zeros(robot.nv)
        wanted[6:] = np.clip(posture.rows(tick).lower, -robot.acceleration, robot.acceleration)
        rows = task.rows(tick)
        for _ in range(50):  # one violated row after the other
            missing = rows.lower - rows.A @ wanted
            worst = int(np.argmax(missing)) if len(missing) else 0
            if not len(missing) or missing[worst] < 1e-9:
                break
            wanted += missing[worst] * rows.A[worst] / (rows.A[worst] @ rows.A[worst])
        q = pin.integrate(robot.model, q, period * v + 0.5 * period**2 * wanted)
        v = v + period * wanted
    assert 0.008 < nearest < 0.02
    assert np.abs(v).max() < 0.05


def test_an_approach_that_is_too_fast_is_stopped_steadily(robot):
    """A hand that comes into view at a speed for which the relied-on deceleration does not do: no kick."""
    task, tick = SelfCollision(robot, min_distance=0.01), Tick(robot)
    turn, every = np.zeros(robot.nv), np.arange(len(task.pairs))
    turn[6:] = crossed(robot)[7:] - robot.rest[7:]
    for share in np.linspace(0.0, 1.0, 200):
        q = pin.integrate(robot.model, robot.rest, share * turn)
        distances, rates, *_ = task.motion(tick.update(0.0, q, turn), every)
        pair = int(np.where(rates < -0.1, distances, np.inf).argmin())
        if distances[pair] < 0.08:
            break
    way, speed = distances[pair] - 0.01, 2.0
    rows = task.rows(tick.update(1.0, q, turn * speed / -rates[pair]))
    least = rows.lower[task.labels.index(" and ".join(task.pairs[pair]))] + task.motion(tick, np.array([pair]))[3][0]
    assert least == pytest.approx(speed**2 / (2.0 * way), rel=0.05)


def test_physics_with_and_without():
    robot, nearest = Robot.load("hrp2"), []
    for add in (False, True):
        stack = standing_stack(robot)
        stack.remove("Posture")
        stack.add(Posture(robot, crossed(robot)[7:]), level="posture")
        if add:
            stack.hard.append(SelfCollision(robot))
        world, controller = World(robot), Controller(robot, stack, Cascade())
        distances = []
        for k in range(800):
            command = controller(0.001 * k, *world.state())
            world.step(command.torque)
            if k % 10 == 0:
                distances.append(world.self_distance())
        nearest.append(min(distances))
    assert nearest[0] < 0.0
    assert nearest[1] > 0.005


def test_as_many_rows_as_were_ever_needed(robot):
    task, tick = SelfCollision(robot), Tick(robot)
    assert len(task.rows(tick.update(0.0, robot.rest, np.zeros(robot.nv))).lower) == 0
    crossing = task.rows(tick.update(0.0, crossed(robot), np.zeros(robot.nv)))
    count = len(crossing.lower)
    assert count > 0 and task.error.max() > 0.0
    spare = task.rows(tick.update(0.0, robot.rest, np.zeros(robot.nv)))
    assert len(spare.lower) == count
    assert (spare.A == 0.0).all() and np.isneginf(spare.lower).all()


def test_is_a_limit_of_level_0_that_gives_way_with_the_joint_bounds(robot):
    task = SelfCollision(robot)
    assert not task.equality and task.variable == "acceleration" and task.gives_way == 1


def test_pairs_that_are_left_alone_are_watched_in_time(robot):
    """Beside a task that leaves pairs alone goes one that looks at all of them each time: what the one has to watch, so
    does the other, as long as no pair speeds up by more than is allowed for."""
    task, every, tick = SelfCollision(robot), SelfCollision(robot), Tick(robot)
    proximity, pairs, joints = Proximity(robot), np.arange(len(task.pairs)), range(6, robot.nv)
    away = crossed(robot)[7:] - robot.rest[7:]
    watched = spared = 0
    rates = None
    for k in range(300):
        t = k * LOOK_PERIOD
        angle, speed = 0.5 - 0.5 * np.cos(np.pi * t), 0.5 * np.pi * np.sin(np.pi * t)
        q, v = robot.rest.copy(), np.zeros(robot.nv)
        q[7:] += angle * away
        v[joints] = speed * away
        tick.update(t, q, v)
        proximity.move_to(tick.data)
        proximity.measure(pairs)
        before, (_, rates) = rates, proximity.jacobian_and_rates(pairs, v)
        if before is not None:
            assert (before - rates < SPEED_CHANGE_BOUND).all()
        every._unwatched_until[:] = -np.inf
        task.rows(tick), every.rows(tick)
        assert set(every.labels) <= set(task.labels)
        watched += len(every.labels)
        spared += int((task._unwatched_until > t + 1.5 * LOOK_PERIOD).sum())
    assert watched > 20
    assert spared > 20
