import mujoco
import numpy as np
import pytest

from sim.world import World
from sot.motion.clearance import ROOM, Clearance, ClearArm
from sot.motion.coordinates import from_configuration, to_configuration
from sot.motion.limits import Limits
from sot.motion.parts import Arm
from sot.motion.retarget import solve
from sot.motion.stance import Build, on_time_line, over_feet
from sot.motion.targets import targets
from sot.robot import Robot
from tests.sot.motion.humans import dancer

STEP = 1e-6


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def arms(robot):
    """A right arm whose forearm is to point into the thigh: as it would, and kept clear."""
    build = Build.of(robot)
    human = on_time_line(over_feet(dancer(1.0), build), 50.0)
    wanted = targets(human, robot, build, np.zeros(human.count))
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


def test_distances_are_those_of_the_physics(robot, postures):
    """Each arm's nearest other shape, by MuJoCo from the same model file."""
    world = World(robot)
    model = world.model
    own = {name: model.geom(name).id for name in ("RARM2_LINK_0", "RARM3_LINK_0", "RARM5_LINK_0")}
    others = [g for g in range(model.ngeom) if model.geom_group[g] == 3 and not model.geom(g).name.startswith("RARM")]
    missing, _ = Clearance(robot, "right", np.array([], dtype=int)).evaluate(postures)
    for k, q in enumerate(to_configuration(postures)):
        world.reset(q)
        apart = [min(mujoco.mj_geomDistance(model, world.data, g, o, 10.0, None) for o in others) for g in own.values()]
        np.testing.assert_allclose(missing[k], np.maximum(ROOM - np.array(apart), 0.0), atol=1e-4)
    assert np.count_nonzero(missing) > 10


def test_jacobian_against_finite_differences(robot, postures, arms):
    columns = arms[0].columns
    clearance = Clearance(robot, "right", columns)
    missing, J = clearance.evaluate(postures)
    near = missing > 1e-4  # elsewhere a step may reach where nothing is missing
    for i, column in enumerate(columns):
        step = STEP * np.eye(robot.nv)[column]
        before, after = (clearance.evaluate(postures + sign * step)[0] for sign in (-1.0, 1.0))
        np.testing.assert_allclose(J[near, i], ((after - before) / (2 * STEP))[near], atol=1e-5)
    assert (J[missing == 0.0] == 0.0).all()


def test_an_arm_that_points_into_the_body_stays_outside(robot, arms):
    least = []
    for arm in arms:
        y = from_configuration(robot.rest[None])
        y[:, arm.columns], _ = solve(arm, np.array([60]), y, Limits.of(robot))
        missing, _ = Clearance(robot, "right", arm.columns).evaluate(y)
        least.append(ROOM - missing.max())
    assert least[0] < 0.0 < 0.75 * ROOM < least[1]


def test_neighbours_at_rest_do_not_push(robot):
    y = from_configuration(robot.rest[None])
    for side in ("left", "right"):
        missing, _ = Clearance(robot, side, np.array([], dtype=int)).evaluate(y)
        assert (missing == 0.0).all()
