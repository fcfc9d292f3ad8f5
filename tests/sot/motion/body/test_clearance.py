import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim.world import World
from sot.motion.body.clearance import Clearance, ClearArm, ClearBody
from sot.motion.body.coordinates import from_configuration, to_configuration
from sot.motion.body.limits import Limits
from sot.motion.body.parts import Arm, Body
from sot.motion.body.retarget import solve_knots
from sot.motion.body.targets import targets_of_human
from sot.motion.feet.stance import Build, human_on_time_line, human_over_feet
from sot.motion.feet.swing import FootPath
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.stance_range import PLANNED_DISTANCE_LEGS
from tests.sot.motion.human.humans import dancer

STEP = 1e-6
WANTED = PLANNED_DISTANCE_LEGS * leg_length(Robot.load("hrp2"))  # m
NO_COLUMNS = np.array([], dtype=int)


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def arms(robot):
    """A right arm whose forearm is to point into the thigh: as it would, and kept clear."""
    build = Build.of(robot)
    human = human_on_time_line(human_over_feet(dancer(1.0), build), 50.0)
    wanted = targets_of_human(human, robot, build, np.zeros(human.count))
    down, inward = np.array([0.0, 0.1, -1.0]), np.array([0.2, 0.6, -1.0])
    wanted.directions["right_upper_arm"][:] = down / np.linalg.norm(down)
    wanted.directions["right_forearm"][:] = inward / np.linalg.norm(inward)
    return Arm(robot, "right", wanted), ClearArm(robot, "right", wanted)


@pytest.fixture(scope="module")
def postures(robot):
    rng = np.random.default_rng(0)
    y = np.tile(from_configuration(robot.rest[None]), (200, 1))
    y[:, 6:] = rng.uniform(robot.lower, robot.upper, (200, robot.na))
    return y


@pytest.fixture(scope="module")
def bodies(robot):
    """Low hips over feet with their toes turned in, where knees meet: as a body would, and kept clear, with its legs'
    clearance."""
    build = Build.of(robot)
    human = human_on_time_line(human_over_feet(dancer(1.0), build), 50.0)
    wanted = targets_of_human(human, robot, build, np.zeros(human.count))
    wanted.hips[:, 2] -= 0.02
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    feet = {}
    for foot, inward in zip(robot.feet, (-0.3, 0.3), strict=True):
        pose = data.oMf[robot.point(foot)]
        turned = pin.utils.rotate("z", inward) @ pose.rotation
        feet[foot] = FootPath(
            np.tile(pose.translation, (human.count, 1)),
            np.tile(turned, (human.count, 1, 1)),
            *np.zeros((2, human.count)),
        )
    legs = Clearance.of_legs(robot, human.count)
    return Body(robot, build, wanted, feet), ClearBody(robot, build, wanted, feet, legs), legs


def test_distances_are_those_of_the_physics(robot, postures):
    """Each arm's nearest other shape, by MuJoCo from the same model file."""
    world = World(robot)
    model = world.model
    own = {name: model.geom(name).id for name in ("RARM2_LINK_0", "RARM3_LINK_0", "RARM5_LINK_0")}
    others = [g for g in range(model.ngeom) if model.geom_group[g] == 3 and not model.geom(g).name.startswith("RARM")]
    missing, _ = Clearance.of_arm(robot, "right", len(postures)).evaluate(
        np.arange(len(postures)), postures, NO_COLUMNS
    )
    for k, q in enumerate(to_configuration(postures)):
        world.reset(q)
        apart = [min(mujoco.mj_geomDistance(model, world.data, g, o, 10.0, None) for o in others) for g in own.values()]
        np.testing.assert_allclose(missing[k], np.maximum(WANTED - np.array(apart), 0.0), atol=1e-4)
    assert np.count_nonzero(missing) > 10


@pytest.mark.parametrize("limb", ["right_arm", "legs"])
def test_jacobian_against_finite_differences(robot, postures, arms, bodies, limb):
    columns = (arms if limb == "right_arm" else bodies)[0].columns
    knots = np.arange(len(postures))
    clearance = (
        Clearance.of_arm(robot, "right", len(knots)) if limb == "right_arm" else Clearance.of_legs(robot, len(knots))
    )
    missing, J = clearance.evaluate(knots, postures, columns)
    near = missing > 1e-4  # elsewhere a step may reach where nothing is missing
    assert np.count_nonzero(near) > 10
    for i, column in enumerate(columns):
        step = STEP * np.eye(robot.nv)[column]
        before, after = (clearance.evaluate(knots, postures + sign * step, columns)[0] for sign in (-1.0, 1.0))
        np.testing.assert_allclose(J[near, i], ((after - before) / (2 * STEP))[near], atol=1e-5)
    assert (J[missing == 0.0] == 0.0).all()


def test_what_was_seen_before_changes_nothing(robot, postures):
    """Along a way between postures, looking again only where something may have come near finds what looking
    everywhere does."""
    for make in (lambda n: Clearance.of_arm(robot, "right", n), lambda n: Clearance.of_legs(robot, n)):
        remembering, found = make(10), 0
        for share in np.linspace(0.0, 1.0, 30):
            y = (1.0 - share) * postures[:10] + share * postures[10:20]
            missing, _ = remembering.evaluate(np.arange(10), y, NO_COLUMNS)
            np.testing.assert_array_equal(missing, make(10).evaluate(np.arange(10), y, NO_COLUMNS)[0])
            found += np.count_nonzero(missing)
        assert found > 10


def test_an_arm_that_points_into_the_body_stays_outside(robot, arms):
    knot, least = np.array([60]), []
    for arm in arms:
        y = from_configuration(robot.rest[None])
        y[:, arm.columns], _ = solve_knots(arm, knot, y, Limits.of(robot))
        missing, _ = Clearance.of_arm(robot, "right", 61).evaluate(knot, y, arm.columns)
        least.append(WANTED - missing.max())
    assert least[0] < 0.0 < 0.75 * WANTED < least[1]


def test_knees_over_toes_that_are_turned_in_stay_apart(robot, bodies):
    knot, least = np.array([60]), []
    *both, legs = bodies
    for body in both:
        y = from_configuration(robot.rest[None])
        y[:, body.columns], _ = solve_knots(body, knot, y, Limits.of(robot))
        missing, _ = legs.evaluate(knot, y, body.columns)
        least.append(WANTED - missing.max())
    assert least[0] < 0.0 < 0.75 * WANTED < least[1]


def test_neighbours_at_rest_do_not_push(robot):
    y, knot = from_configuration(robot.rest[None]), np.array([0])
    for clearance in (*(Clearance.of_arm(robot, side, 1) for side in ("left", "right")), Clearance.of_legs(robot, 1)):
        missing, _ = clearance.evaluate(knot, y, NO_COLUMNS)
        assert (missing == 0.0).all()
