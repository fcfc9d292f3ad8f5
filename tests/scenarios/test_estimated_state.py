"""A loop closed on an estimated state: nothing in it reads the simulated one."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from scenarios import stacks
from scenarios.inputs.plant import estimator_of, hardware_of
from scenarios.replay import Replay, dance
from sim.loop import run
from sim.reporting.estimator import estimator_figures
from sim.world import World
from solvers import Cascade
from sot.control.contact import Contact
from sot.control.controller import Controller
from sot.errors import InputError
from sot.estimation import ContactFilter
from sot.hardware.hardware import Hardware
from sot.hardware.sensors import Channel, sensor_preset
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.surface import Surface

RATE = 500.0


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def stand(robot: Robot, sensors, seconds: float = 0.4, motion: Motion | None = None):
    motion = motion or Motion.standing(robot, seconds, RATE)
    world = World(robot, 1.0 / RATE, hardware=Hardware(sensors=sensors))
    controller = Controller(robot, stacks.planted_stack(robot, motion), Cascade(), period=1.0 / RATE)
    done = run(controller, world, motion, estimator=ContactFilter(robot, sensors))
    assert done.fell_at_s is None
    return done.log.trimmed(), estimator_figures(done.log.trimmed(), motion)


def test_a_robot_stands_on_what_its_sensors_say(robot):
    log, figures = stand(robot, sensor_preset("bmi088"))
    assert figures["position_max_m"] < 5e-3 and figures["tilt_rms_deg"] < 0.5
    assert not np.array_equal(log.base_estimate, log.q[:, :7])  # the controller was told something else


def test_other_contacts_than_soles_are_refused(robot):
    motion = Motion.standing(robot, 0.1, RATE)
    stack = stacks.planted_stack(robot, motion)
    stack.contacts.append(Contact(robot.surface("left_palm"), Surface("table", np.zeros((4, 3)))))
    world = World(robot, 1.0 / RATE, hardware=Hardware(sensors=sensor_preset("ideal")))
    with pytest.raises(InputError, match="other than of soles: left_palm"):
        run(
            Controller(robot, stack, Cascade(), 1.0 / RATE),
            world,
            motion,
            estimator=ContactFilter(robot, world.hardware.sensors),
        )


def test_state_and_sensors_by_name(robot):
    assert hardware_of(robot, "torque", None).sensors is None
    hardware = hardware_of(robot, "torque", None, "estimated", "mti630", 3)
    assert hardware.sensors == sensor_preset("mti630", 3)
    assert estimator_of(robot, hardware, "true") is None and estimator_of(robot, hardware, "estimated") is not None
    with pytest.raises(InputError, match="unknown state"):
        hardware_of(robot, "torque", None, "guessed")
    with pytest.raises(InputError, match="unknown sensors"):
        hardware_of(robot, "torque", None, "estimated", "guess")
    with pytest.raises(InputError, match="add --state estimated"):
        hardware_of(robot, "torque", None, "true", "bmi088")


def displaced(motion: Motion, place: pin.SE3) -> Motion:
    """A motion somewhere else, turned about the vertical."""
    q, turn = motion.q.copy(), place.rotation
    for row in q:
        row[:7] = pin.SE3ToXYZQUAT(place * pin.XYZQUATToSE3(row[:7]))
    zmp = np.column_stack([motion.zmp, np.zeros(len(q))]) @ turn.T + place.translation
    phases = tuple(
        replace(phase, feet={foot: place * pose for foot, pose in phase.feet.items()}) for phase in motion.phases
    )
    return replace(
        motion,
        q=q,
        com=motion.com @ turn.T + place.translation,
        com_velocity=motion.com_velocity @ turn.T,
        com_acceleration=motion.com_acceleration @ turn.T,
        momentum=motion.momentum @ turn.T,
        zmp=zmp[:, :2],
        phases=phases,
    )


@pytest.mark.slow
def test_far_from_the_origin_and_turned_it_does_as_it_does_there(robot, tmp_path):
    motion = dance(Replay("groove", duration=2.0, rate=RATE), lambda *_: None).motion
    place = pin.SE3(pin.exp3(np.deg2rad(137.0) * np.array([0.0, 0.0, 1.0])), np.array([80.0, -60.0, 0.0]))
    (_, here), (_, there) = (
        stand(robot, sensor_preset("bmi088"), motion=at) for at in (motion, displaced(motion, place))
    )
    for figure in ("position_max_m", "tilt_rms_deg", "velocity_rms_m_s"):
        assert there[figure] == pytest.approx(here[figure], rel=0.05)


@pytest.mark.slow
def test_large_biases_do_not_make_a_dance_fall(robot):
    sensors = replace(
        sensor_preset("ideal"),
        angular_velocity=Channel(bias=np.deg2rad(1.0)),
        specific_force=Channel(bias=0.05 * 9.81),
    )
    motion = dance(Replay("groove", duration=2.0, rate=RATE), lambda *_: None).motion
    _, figures = stand(robot, sensors, motion=motion)
    assert figures["position_max_m"] < 0.02 and figures["tilt_rms_deg"] < 0.5
