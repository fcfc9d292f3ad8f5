"""The floor under a robot that stands, against what a moment turns its soles by."""

import numpy as np
import pytest

from sim.hardware.floor_contacts import floor_contacts
from sim.hardware.soles import sole_body
from sim.push import Push
from sim.world import World
from sot.gravity import GRAVITY
from sot.hardware import FootCompliance, JointTargets, Sensors, Servo
from sot.hardware.compliance import bush_position
from sot.hardware.hardware import Hardware
from sot.robots.robot import Robot


def leaning(robot, force):
    """A robot that a steady force leans."""
    hardware = Hardware(Servo.of(robot), FootCompliance(4000.0, 4000.0, 4e5, loss=1.0), Sensors())
    world = World(robot, 0.002, pushes=[Push(0.0, force, 10.0)], hardware=hardware)
    for _ in range(600):
        world.step(JointTargets(robot.rest[7:], np.zeros(robot.na)))
    return world


def test_stiffness_is_what_turns_and_sinks_soles():
    robot = Robot.load("hrp2")
    push = 0.02 * robot.mass * GRAVITY
    worlds = [
        leaning(robot, force) for force in ((0.0, 0.0, 0.0), (push, 0.0, 0.0), (0.0, push, 0.0), (0.0, 0.0, -push))
    ]
    foot = robot.feet[0]
    body, bush = worlds[0].model.body(sole_body(foot)).id, bush_position(robot, foot)
    found = floor_contacts(worlds[0].model, worlds[0].data, robot)
    assert set(found) == set(robot.feet)

    def state(world):
        """Roll, pitch and height of the sole, moments and force that it bears."""
        turn, wrench = world.data.xmat[body].reshape(3, 3), world.readings().foot_wrench[foot]
        moment = wrench[3:] - np.cross(bush, wrench[:3])
        return np.array([turn[2, 1], -turn[2, 0], world.data.xpos[body][2], moment[0], moment[1], wrench[2]])

    at_rest = state(worlds[0])
    for k, world in zip((1, 0, 2), worlds[1:], strict=True):
        change = state(world) - at_rest
        assert -change[3 + k] / change[k] == pytest.approx(found[foot].stiffness[k], rel=0.1)
