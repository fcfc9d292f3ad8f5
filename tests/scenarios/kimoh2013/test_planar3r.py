"""Kim & Oh's section 3.3: what both methods promise on the planar arm, and what their braking costs."""

from functools import partial

import numpy as np
import pytest

from scenarios import cli
from scenarios.kimoh2013 import planar3r
from scenarios.kimoh2013 import planar_arm as arm
from scenarios.kimoh2013.rivals import ClampedCascade, LevelByLevel
from solvers import Cascade, TaskCorrection

PERIOD = 0.001


@pytest.fixture(scope="module")
def tracks():
    solvers = {"cascade": Cascade, "a QP a level": LevelByLevel, "iktc": TaskCorrection, "clamped": ClampedCascade}
    return {
        name: planar3r.follow_tasks(solver(), planar3r.viable_bounds(planar3r.BRAKING_SHARE), PERIOD)
        for name, solver in solvers.items()
    }


def states(count=20):
    rng = np.random.default_rng(0)
    return zip(rng.uniform(-3, 3, (count, 3)), rng.uniform(-3, 3, (count, 3)), strict=True)


def test_jacobian_and_drift_are_the_tasks_derivatives():
    step = 1e-6
    for q, v in states():
        seen, after, before = arm.task_state(q, v), arm.task_state(q + step * v, v), arm.task_state(q - step * v, v)
        np.testing.assert_allclose(seen.jacobian @ v, (after.value - before.value) / (2 * step), atol=1e-7)
        np.testing.assert_allclose(seen.drift, (after.jacobian - before.jacobian) @ v / (2 * step), atol=1e-6)
        tip = arm.link_ends(q[None])[0, -1]
        np.testing.assert_allclose(seen.value[:2], tip[::-1], atol=1e-12)


def test_what_is_desired_starts_where_the_arm_does_and_its_rates_are_its_derivatives():
    np.testing.assert_allclose(
        arm.desired_tasks(0.0)[0], arm.task_state(arm.START_ANGLES, np.zeros(3)).value, atol=1e-12
    )
    step = 1e-6
    for t in (0.1, 0.5, 0.9):
        _, rate, acceleration = arm.desired_tasks(t)
        after, before = arm.desired_tasks(t + step), arm.desired_tasks(t - step)
        np.testing.assert_allclose(rate, (after[0] - before[0]) / (2 * step), atol=1e-8)
        np.testing.assert_allclose(acceleration, (after[1] - before[1]) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("method", ["cascade", "a QP a level", "iktc", "clamped"])
def test_no_limit_is_exceeded(tracks, method):
    track = tracks[method]
    assert track.max_beyond_range < 1e-9
    assert np.all(np.abs(track.v) <= arm.VELOCITY + 1e-7)
    assert np.all(np.abs(track.a) <= arm.ACCELERATION + 1e-5)
    if method != "clamped":
        assert track.q[:, 0].min() == pytest.approx(arm.LOWER[0], abs=1e-4)  # the limit that the task runs into


def test_the_first_two_tasks_are_kept_and_the_third_gives_way(tracks):
    for method in ("cascade", "a QP a level", "iktc"):
        error = np.abs(tracks[method].error)
        assert error[:, :2].max() < 1e-4
        assert np.deg2rad(20.0) < error[:, 2].max() < np.deg2rad(40.0)
    assert np.abs(tracks["clamped"].error[:, :2]).max() > 0.1


def test_one_quadratic_program_a_tick_instead_of_three(tracks):
    assert tracks["iktc"].qps.max() == 1 and 0.3 < tracks["iktc"].qps.mean() < 0.8
    assert np.all(tracks["a QP a level"].qps == 3)


def test_iktc_and_cascade_agree_where_no_bound_is_active_and_where_the_last_task_alone_gives_way(tracks):
    np.testing.assert_allclose(tracks["iktc"].a, tracks["cascade"].a, atol=1e-6)
    np.testing.assert_allclose(tracks["a QP a level"].q, tracks["cascade"].q, atol=1e-6)


def test_a_joint_that_brakes_with_all_it_may_leaves_the_others_too_little():
    """With the brake of Kim (14) no method keeps the tip's height: what it takes of q_2 is beyond its limit."""
    bounds = partial(planar3r.viable_bounds, 1.0)
    tracks = [planar3r.follow_tasks(solver(), bounds(), PERIOD) for solver in (Cascade, LevelByLevel, TaskCorrection)]
    for track in tracks:
        assert 0.01 < np.abs(track.error[:, 0]).max() < 0.1
        assert track.max_beyond_range < 1e-9
        k = int(np.argmax(track.a[:, 0] > 0.9 * arm.ACCELERATION[0]))
        J, h = arm.task_rows(track.time[k], track.q[k], track.v[k])
        needed = np.linalg.solve(J[:2, 1:], h[:2] - J[:2, 0] * track.a[k, 0])
        assert needed[0] < -1.3 * arm.ACCELERATION[1]


def test_bounds_as_printed_break_a_limit():
    track = planar3r.follow_tasks(TaskCorrection(), planar3r.printed_bounds_with_fallback(), PERIOD)
    assert track.max_beyond_range > 1e-5 and np.abs(track.a / arm.ACCELERATION).max() > 1.2


def test_runs_from_the_command_line(tmp_path, capsys):
    assert cli.main(["run", "planar3r", "--rate", "200", "--out", str(tmp_path / "arm")]) == cli.DONE
    assert "QPs a tick" in capsys.readouterr().out
    assert sorted(path.name for path in (tmp_path / "arm").iterdir()) == ["planar3r.svg", "report.json", "run.rrd"]


@pytest.mark.parametrize("option", [["--robot", "hrp2_modified"], ["--solver", "weighted"], ["--mismatch", "mass=1.1"]])
def test_takes_no_options_of_a_robot_under_physics(option, tmp_path, capsys):
    assert cli.main(["run", "planar3r", *option, "--out", str(tmp_path / "arm")]) == cli.BAD_INPUT
    assert "no options but --rate and --out" in capsys.readouterr().err
    assert not (tmp_path / "arm").exists()
