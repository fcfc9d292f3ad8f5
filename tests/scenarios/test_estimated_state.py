"""A loop closed on an estimated state: nothing in it reads the simulated one."""

from dataclasses import replace

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from scenarios import stacks
from scenarios.inputs.plant import estimator_of, hardware_of
from sim.loop import run
from sim.mismatch import NO_MISMATCH, Mismatch
from sim.own_scene import Scene
from sim.reporting.estimator import estimator_figures
from sim.world import World
from solvers import Cascade
from sot.control.contact import Contact
from sot.control.controller import Controller
from sot.errors import InputError
from sot.estimation import ContactFilter
from sot.gravity import GRAVITY
from sot.hardware.hardware import Hardware
from sot.hardware.sensors import Channel, Sensors, sensor_preset
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.surface import Surface
from tests.sot.behaviours.stepping import stepping_motion

RATE = 500.0
BMI088 = sensor_preset("bmi088")
DROP, STRIDE = 0.012, 0.3
"""How much lower than planned a floor is, and a step that ends beyond where the feet stood [m]."""


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def motion(robot) -> Motion:
    """Two steps, whose feet land beyond where they stood."""
    return stepping_motion(robot, STRIDE, rate=RATE)


def stepped(
    motion: Motion, sensors: Sensors = BMI088, mismatch: Mismatch = NO_MISMATCH, scene: Scene | None = None
) -> tuple[ContactFilter, dict]:
    """The filter and its errors after a motion that steps, on the state that it makes of readings."""
    robot = motion.robot
    world = World(robot, 1.0 / RATE, mismatch, (), scene, hardware=Hardware(sensors=sensors))
    stack, schedule = stacks.stepping_stack(robot, motion), stacks.stepping_schedule(robot, motion)
    estimator = ContactFilter(robot, sensors)
    controller = Controller(robot, stack, Cascade(), 1.0 / RATE, schedule)
    done = run(controller, world, motion, estimator=estimator)
    assert done.fell_at_s is None, done.reason
    return estimator, estimator_figures(done.log.trimmed(), motion)


def floor_that_drops(motion: Motion) -> Scene:
    """A floor that is lower than planned, but for where the feet stand at first."""

    def scene(spec: mujoco.MjSpec) -> None:
        toes = 0.0
        for foot, pose in motion.phases[0].feet.items():
            sole = motion.robot.surface(foot)
            toes = max(toes, *((pose * sole.placement).act(corner)[0] for corner in sole.corners))
        spec.geom("floor").pos = [0.0, 0.0, -DROP]
        plate = spec.worldbody.add_body(name="plate", pos=[toes + 0.01 - 1.0, 0.0, -0.5 * DROP])
        plate.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[1.0, 1.0, 0.5 * DROP])

    return scene


def test_a_robot_stands_on_what_its_sensors_say(robot):
    motion = Motion.standing(robot, 0.4, RATE)
    world = World(robot, 1.0 / RATE, hardware=Hardware(sensors=BMI088))
    controller = Controller(robot, stacks.planted_stack(robot, motion), Cascade(), period=1.0 / RATE)
    done = run(controller, world, motion, estimator=ContactFilter(robot, BMI088))
    log, figures = done.log.trimmed(), estimator_figures(done.log.trimmed(), motion)
    assert done.fell_at_s is None and figures["position_max_m"] < 5e-3 and figures["tilt_rms_deg"] < 0.5
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
def test_far_from_the_origin_and_turned_it_does_as_it_does_there(motion):
    place = pin.SE3(pin.exp3(np.deg2rad(137.0) * np.array([0.0, 0.0, 1.0])), np.array([80.0, -60.0, 0.0]))
    (_, here), (_, there) = (stepped(at) for at in (motion, displaced(motion, place)))
    for figure in ("position_max_m", "tilt_rms_deg", "velocity_rms_m_s"):
        assert there[figure] == pytest.approx(here[figure], rel=0.05)


@pytest.mark.slow
def test_large_biases_do_not_make_a_walk_fall(motion):
    """1 °/s and 50 mg, of which the data sheet says so much."""
    gyro, accelerometer = Channel(bias=np.deg2rad(1.0)), Channel(bias=0.05 * GRAVITY)
    _, figures = stepped(motion, Sensors(angular_velocity=gyro, specific_force=accelerometer))
    assert figures["position_max_m"] < 0.02 and figures["tilt_rms_deg"] < 0.5


@pytest.mark.slow
def test_a_floor_that_is_lower_than_planned(motion):
    """Both feet touch down late. The filter believes in the planned floor, and is off by what that is off."""
    _, figures = stepped(motion, scene=floor_that_drops(motion))
    assert 0.8 * DROP < figures["position_end_m"] < 1.2 * DROP
    assert figures["position_max_m"] < 1.5 * DROP and figures["tilt_max_deg"] < 1.0


@pytest.mark.slow
def test_feet_that_slip(motion):
    """A floor like ice: feet slip under the robot, are found out, and the state does not go astray."""
    estimator, figures = stepped(motion, mismatch=Mismatch(friction=0.1))
    assert estimator.slips.sum() > 0
    assert figures["position_max_m"] < 0.1 and figures["tilt_max_deg"] < 1.0 and figures["velocity_rms_m_s"] < 0.1
