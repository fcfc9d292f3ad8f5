"""Position controllers in the loop: what they are told, what their run logs, and that it does not matter where."""

from dataclasses import replace

import numpy as np
import pytest

from sim.log import FOOT_FIXED, FOOT_ROLLING, FOOT_SLIDING, RunInfo, RunLog
from sim.loop import run
from sim.mismatch import Mismatch
from sim.push import Push
from sim.reporting.report import run_report
from sim.world import World
from solvers.rows import Status
from sot.hardware import FootCompliance, JointTargets, Readings, Sensors, Servo
from sot.hardware.hardware import Hardware
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo import Stabiliser

PERIOD = 0.002
SOFT = FootCompliance(2500.0, 2500.0)


@pytest.fixture(scope="module")
def motion() -> Motion:
    return Motion.standing(Robot.load("hrp2"), 0.4, 1.0 / PERIOD)


def servo_world(robot: Robot, compliance: FootCompliance | None = SOFT, **options) -> World:
    return World(robot, PERIOD, hardware=Hardware(Servo.of(robot), compliance, Sensors()), **options)


def pushed_run(motion: Motion, force: tuple[float, float, float]) -> RunLog:
    world = servo_world(motion.robot, pushes=[Push(0.1, force)])
    done = run(Stabiliser(motion, PERIOD), world, motion)
    assert done.fell_at_s is None
    return done.log.trimmed()


def test_a_position_controller_is_told_state_and_readings_and_its_targets_are_logged(motion):
    class Listening(Stabiliser):
        heard: tuple = ()

        def __call__(self, t: float, q: np.ndarray, v: np.ndarray, readings: Readings) -> JointTargets:
            self.heard = (*self.heard, (t, q, v, readings))
            return super().__call__(t, q, v, readings)

    controller, world = Listening(motion, PERIOD), servo_world(motion.robot, mismatch=Mismatch(noise=0.01))
    log = run(controller, world, motion).log.trimmed()
    times, qs, vs, readings = zip(*controller.heard, strict=True)
    np.testing.assert_allclose(times, log.time)
    np.testing.assert_array_equal(np.array(qs), log.q)
    noise = np.array(vs) - log.v
    assert np.std(noise[:, 3:]) == pytest.approx(0.01, rel=0.05) and not noise[:, :3].any()
    np.testing.assert_allclose([one.time for one in readings[1:]], log.time[1:] - 0.001)
    np.testing.assert_allclose(log.target, np.tile(motion.robot.rest[7:], (log.ticks, 1)))
    assert (log.foot_mode == FOOT_FIXED).all() and (log.foot_ramp == 1.0).all()
    assert (log.status == Status.SOLVED).all()
    assert (np.abs(log.torque) <= motion.robot.effort * (1 + 1e-12)).all()
    for column in (log.torque, log.com, log.sole_deflection, log.foot_reading, log.zmp_planned):
        assert np.isfinite(column).all()


def test_the_report_has_figures_of_servos_and_soles(motion):
    log = pushed_run(motion, (20.0, 0.0, 0.0))
    info = RunInfo("made-up", "hrp2", "open loop", "planted", 1.0 / PERIOD, hardware=servo_world(motion.robot).hardware)
    report = run_report(log, info, 1.0, motion, None)
    servo = report["servo"]
    assert report["plant"] == {"joints": "servo", "feet_compliance": [2500.0, 2500.0, None]}
    error = np.abs(log.q[:, 7:] - log.target)
    assert servo["error_max_rad"] == pytest.approx(error.max(), rel=1e-5)
    assert servo["error_rms_rad"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-5)
    assert next(iter(servo["worst_joints"])) == motion.robot.joints[int(error.max(axis=0).argmax())]
    assert servo["sole_deflection_max_rad"] == pytest.approx(
        np.linalg.norm(log.sole_deflection[..., :2], axis=2).max(), rel=1e-5
    )
    assert servo["sole_sink_max_m"] == 0.0
    assert 0.0 < servo["sensed_zmp_rms_m"] < 0.01
    assert report["contacts"]["sole_tilt_max_deg"] < 0.3 * np.rad2deg(servo["sole_deflection_max_rad"])


def test_it_does_not_matter_where_on_earth_a_robot_stands(motion):
    """Pushed forward 100 m away and turned by 137°, it rocks as at the origin; the push turns with it."""
    yaw, force = np.deg2rad(137.0), np.array([20.0, 0.0, 0.0])
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    far = motion.placed(70.0, -72.0, yaw)
    here, there = pushed_run(motion, tuple(force)), pushed_run(far, tuple(turn @ force))
    np.testing.assert_allclose(there.com, here.com @ turn.T + [70.0, -72.0, 0.0], atol=1e-4)
    np.testing.assert_allclose(there.sole_deflection, here.sole_deflection, atol=1e-4)
    np.testing.assert_allclose(there.foot_reading[10:], here.foot_reading[10:], atol=0.02 * 9.81 * motion.robot.mass)
    assert np.ptp(here.com[:, 0]) > 2e-3


def test_a_robot_on_servos_can_fall(motion):
    """HRP-2's own rubber in a stronger push."""
    world = servo_world(motion.robot, FootCompliance(707.0, 502.0), pushes=[Push(0.0, (150.0, 0.0, 0.0), 0.3)])
    longer = Motion.standing(motion.robot, 2.0, 1.0 / PERIOD)
    done = run(Stabiliser(longer, PERIOD), world, longer)
    assert done.fell_at_s is not None and done.fell_at_s < 2.0 and done.reason


def test_feet_are_logged_as_their_motion_has_them(motion):
    """A heel that rises, and a foot that slides, are not told as feet that stand flat."""
    (stance,) = motion.phases
    left, right = motion.robot.feet
    parts = replace(stance, end=0.2), replace(stance, start=0.2, rising=(left,), sliding=(right,))
    moved = replace(motion, phases=parts)
    log = run(Stabiliser(moved, PERIOD), servo_world(motion.robot), moved).log.trimmed()
    half = log.ticks // 2
    assert (log.foot_mode[: half - 1] == FOOT_FIXED).all()
    assert (log.foot_mode[half + 1 :] == (FOOT_ROLLING, FOOT_SLIDING)).all()


def test_only_a_planned_motion_can_be_followed(motion):
    class Live:
        duration = 1.0

    with pytest.raises(TypeError, match="phases are known"):
        run(Stabiliser(motion, PERIOD), servo_world(motion.robot), Live())
