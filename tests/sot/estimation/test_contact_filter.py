"""The filter on a robot whose motion and readings are known: it follows, and nothing makes it diverge."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.estimation import ContactFilter, FilterNoise, Footing
from sot.gravity import GRAVITY
from sot.hardware.readings import Readings
from sot.hardware.sensors import Sensors, sensor_preset
from sot.robots.robot import Robot
from tests.sot.estimation.stepping import PERIOD, STANCE_S, SteppingMotion

DEGREE = np.pi / 180.0


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


class Followed:
    """A filter that has followed a motion.

    Args:
        motion: the motion.
        seconds: how long.
        sensors: data sheets that the filter knows.
        errors: makes readings of perfect ones.
        late: by how long each foot's load comes after it is planned to stand [s].
        footholds: whether the filter is told where the feet stand.
        floor: whether it is told where the floor is.
    """

    def __init__(
        self, motion, seconds=1.9, sensors=None, errors=lambda readings: readings, late=0.0, footholds=False, floor=True
    ):
        self.filter = ContactFilter(motion.robot, sensors or Sensors())
        self.filter.reset(*motion.state(PERIOD))
        self.position, self.tilt, self.heading, self.velocity = [], [], [], []
        for k in range(1, round(seconds / PERIOD)):
            t = k * PERIOD + 1e-4 * (k * PERIOD % STANCE_S < 1e-9)
            foot, since = motion.foot(t), t % STANCE_S
            loads = {foot: 1.0 if since >= late or t < STANCE_S else 0.0}
            known = motion.footing(t).floor
            standing = {foot: Footing(known if floor else None, known if footholds else None)}
            q, v = self.filter(t, errors(motion.readings(t, loads)), standing)
            self._compare(q, v, *motion.state(t))

    def _compare(self, q, v, true_q, true_v):
        rotation, truth = (pin.Quaternion(values[3:7]).matrix() for values in (q, true_q))
        turn = pin.log3(rotation @ truth.T)
        self.position.append(np.linalg.norm(q[:3] - true_q[:3]))
        self.tilt.append(np.linalg.norm(turn[:2]) / DEGREE)
        self.heading.append(abs(turn[2]) / DEGREE)
        self.velocity.append(np.linalg.norm(rotation @ v[:3] - truth @ true_v[:3]))


def with_biases(gyro: float, accelerometer: float):
    """Readings with biases of these sizes, in directions of mixed signs."""
    signs = np.array([1.0, -1.0, 1.0])

    def spoilt(readings: Readings) -> Readings:
        return replace(
            readings,
            angular_velocity=readings.angular_velocity + gyro * signs,
            specific_force=readings.specific_force + accelerometer * signs,
        )

    return spoilt


def test_perfect_readings_give_the_state(robot):
    followed = Followed(SteppingMotion(robot))
    assert max(followed.position) < 1e-3 and max(followed.tilt) < 0.05 and max(followed.velocity) < 0.01


def test_the_state_is_that_of_now(robot):
    """Readings that are older than the tick are carried on to it."""
    motion, age = SteppingMotion(robot), 0.004
    estimator = ContactFilter(robot, Sensors())
    estimator.reset(*motion.state(PERIOD))
    for k in range(1, 100):
        t = k * PERIOD
        q, v = estimator(t + age, motion.readings(t, {motion.foot(t): 1.0}), {motion.foot(t): motion.footing(t)})
    (then_q, then_v), (now_q, now_v) = motion.state(t), motion.state(t + age)
    assert q == pytest.approx(now_q, abs=2e-4) and np.linalg.norm(q - then_q) > 1e-3
    assert np.linalg.norm(v - now_v) < 0.2 * np.linalg.norm(v - then_v)


def test_biases_are_found(robot):
    """1 deg/s and 50 mg, of which the data sheet says nothing."""
    gyro, accelerometer = 1.0 * DEGREE, 0.05 * GRAVITY
    followed = Followed(SteppingMotion(robot), errors=with_biases(gyro, accelerometer))
    assert max(followed.position) < 0.02 and max(followed.tilt) < 1.0
    belief, signs = followed.filter.belief, np.array([1.0, -1.0, 1.0])
    assert belief.gyro_bias == pytest.approx(gyro * signs, abs=0.3 * gyro)
    assert belief.accelerometer_bias == pytest.approx(accelerometer * signs, abs=0.3 * accelerometer)
    assert np.mean(followed.tilt[-100:]) < 0.3


def test_noise_of_a_data_sheet(robot):
    sensors, rng = sensor_preset("bmi088"), np.random.default_rng(0)

    def noisy(readings: Readings) -> Readings:
        gyro = readings.angular_velocity + sensors.angular_velocity.noise * rng.standard_normal(3)
        accelerometer = readings.specific_force + sensors.specific_force.noise * rng.standard_normal(3)
        return replace(readings, angular_velocity=gyro, specific_force=accelerometer)

    followed = Followed(SteppingMotion(robot), sensors=sensors, errors=noisy)
    assert max(followed.position) < 3e-3 and np.sqrt(np.mean(np.square(followed.tilt))) < 0.2


def test_a_late_touch_down_moves_nothing(robot):
    """The foot carries 60 ms later than planned: until then it counts as swinging, and no other stands."""
    followed = Followed(SteppingMotion(robot), late=0.06)
    assert max(followed.position) < 5e-3 and max(followed.tilt) < 0.2


def test_a_foot_that_slips_is_found_out(robot):
    """A slip of 30 mm within 100 ms: the only foot that stands moves, and the body is not taken along for long."""

    def slip(t: float) -> np.ndarray:
        share = np.clip((t - 0.5) / 0.1, 0.0, 1.0)
        return np.array([0.03 * share**3 * (10.0 - 15.0 * share + 6.0 * share**2), 0.0, 0.0])

    motion = SteppingMotion(robot, slip)
    followed = Followed(motion, seconds=0.98)
    assert followed.filter.slips.sum() > 0
    assert max(followed.position) < 0.03 and max(followed.tilt) < 1.0
    assert max(followed.velocity[-60:]) < 0.05


def test_footholds_take_drift_away(robot):
    """A robot that is set down 20 mm beside where it thinks: nobody but the plan's footholds can tell."""
    motion, moved = SteppingMotion(robot), pin.SE3(np.eye(3), np.array([0.02, 0.0, 0.0]))
    beside = SteppingMotion(robot, place=moved)
    noise = replace(FilterNoise.of(robot, Sensors()), start_position=0.03)
    without, told = (ContactFilter(robot, Sensors(), noise=noise, footholds=True) for _ in range(2))
    for estimator in (without, told):
        estimator.reset(*motion.state(PERIOD))
        for k in range(1, 190):
            t, foot = k * PERIOD, motion.foot(k * PERIOD)
            known = beside.sole(t) if estimator is told else None
            q, _ = estimator(t, beside.readings(t, {foot: 1.0}), {foot: Footing(beside.sole(t), known)})
        off = np.linalg.norm(q[:3] - beside.state(t)[0][:3])
        assert (off < 0.008) if estimator is told else (off > 0.015)


def test_far_from_the_origin_and_turned_it_errs_as_it_does_there(robot):
    place = pin.SE3(pin.exp3(np.array([0.0, 0.0, 137.0 * DEGREE])), np.array([80.0, -60.0, 0.0]))
    errors = with_biases(1.0 * DEGREE, 0.02 * GRAVITY)
    here, there = (
        Followed(SteppingMotion(robot, place=at), seconds=1.4, errors=errors) for at in (pin.SE3.Identity(), place)
    )
    for figure in ("position", "tilt", "velocity"):
        assert getattr(there, figure)[-1] == pytest.approx(getattr(here, figure)[-1], rel=0.05, abs=1e-7)


def test_without_floor_and_footholds_heading_and_place_stay_what_they_were(robot):
    followed = Followed(SteppingMotion(robot), floor=False)
    assert max(followed.position) < 2e-3 and max(followed.heading) < 0.1


def test_loads_are_those_of_the_force_sensors(robot):
    followed = Followed(SteppingMotion(robot), seconds=0.2)
    weight = robot.mass * GRAVITY
    standing, swinging = robot.feet
    assert followed.filter.loads[standing] == pytest.approx(weight, rel=0.03)
    assert abs(followed.filter.loads[swinging]) < 0.03 * weight
