"""The board's columns, on motions whose figures are known beforehand, and what ends a run."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios.board.protocol import BODIES, RATE_HZ, Bodies, board_figures, laid_at
from sot.robots.robot import Robot

STEPS = 40


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("g1")


@pytest.fixture
def still(robot) -> np.ndarray:
    return np.tile(robot.rest, (STEPS, 1))


def figures(robot, reference, done, power=12.0, loaded=True):
    return board_figures(robot, reference, done, np.full(len(done), power), np.full((len(done), 2), loaded))


def test_a_perfect_run_is_done_to_the_end_without_errors(robot, still):
    told = figures(robot, still, still)
    assert told["completion"] == told["mjlab_completion"] == 1.0 and told["steps"] == STEPS
    assert told["local_mpjpe_mm"] == told["joint_mae_rad"] == told["root_drift_mm"] == told["slip_m_s"] == 0.0
    assert told["power_w"] == 12.0


def test_a_robot_that_creeps_drifts_and_slips_but_is_locally_right(robot, still):
    done = still.copy()
    done[:, 0] += 0.1 * np.arange(STEPS) / RATE_HZ
    told = figures(robot, still, done)
    assert told["completion"] == 1.0 and told["local_mpjpe_mm"] == pytest.approx(0.0, abs=1e-9)
    assert told["root_drift_mm"] == pytest.approx(100.0 * 0.5 * (STEPS - 1) / RATE_HZ)
    assert told["slip_m_s"] == pytest.approx(0.1) == told["loaded_slip_m_s"]
    assert figures(robot, still, done, loaded=False)["loaded_slip_m_s"] == 0.0


def test_feet_in_the_air_do_not_slip(robot, still):
    done = still.copy()
    done[:, 0] += 0.1 * np.arange(STEPS) / RATE_HZ
    done[:, 2] += 0.06
    assert figures(robot, still, done)["slip_m_s"] == 0.0


def test_a_joint_that_is_off_counts_among_all_and_moves_its_own_links(robot, still):
    done = still.copy()
    done[:, 7 + robot.joints.index("left_elbow_joint")] += 0.29
    told = figures(robot, still, done)
    assert told["joint_mae_rad"] == pytest.approx(0.29 / len(robot.joints))
    moved = np.linalg.norm(Bodies.of(robot, done[:1]).place - Bodies.of(robot, still[:1]).place, axis=2)[0]
    assert moved[BODIES.index("left_wrist_yaw_link")] > 0.02 and np.count_nonzero(moved > 1e-9) == 1
    assert told["local_mpjpe_mm"] == pytest.approx(1e3 * moved.mean())


@pytest.mark.parametrize(("sunk", "board", "mjlab"), [(0.24, 1.0, 1.0), (0.26, 1.0, 0.5), (0.31, 0.5, 0.5)])
def test_heights_end_a_run_by_each_rule(sunk, board, mjlab, robot, still):
    done = still.copy()
    done[STEPS // 2 :, 2] -= sunk
    told = figures(robot, still, done)
    assert (told["completion"], told["mjlab_completion"]) == (board, mjlab)
    assert told["steps"] == board * STEPS


@pytest.mark.parametrize(("degrees", "board"), [(84.0, 1.0), (150.0, 0.25)])
def test_a_robot_that_tilts_is_ended_by_gravity_and_by_the_shoulder(degrees, board, robot, still):
    done = still.copy()
    done[10:, 3:7] = pin.Quaternion(pin.utils.rotate("y", np.deg2rad(degrees))).coeffs()
    told = figures(robot, still, done)
    assert (told["completion"], told["mjlab_completion"]) == (board, 0.25)


def test_a_run_that_fell_has_the_steps_that_it_did(robot, still):
    told = figures(robot, still, still[:10])
    assert told["completion"] == 0.25 and told["steps"] == 10
    assert figures(robot, still, still[:1])["local_mpjpe_mm"] is None


def test_a_reference_is_laid_where_the_robot_stands_and_faces(robot, still):
    reference = still.copy()
    reference[:, 0] += np.linspace(0.0, 1.0, STEPS)
    start = robot.rest.copy()
    start[:2] = 2.0, -1.0
    start[3:7] = pin.Quaternion(pin.utils.rotate("z", 0.5 * np.pi)).coeffs()
    laid = laid_at(reference, start)
    np.testing.assert_allclose(laid[0, :7], start[:7], atol=1e-12)
    np.testing.assert_allclose(laid[-1, :3], (2.0, 0.0, start[2]), atol=1e-12)
    assert figures(robot, laid, laid)["root_drift_mm"] == 0.0
