"""A robot with servos and compliant feet that stands, on both feet or on one, its weight over their bushes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from sim.push import Push
from sim.world import World
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance, bush_position
from sot.hardware.hardware import Hardware
from sot.hardware.sensors import Sensors
from sot.hardware.servo import Servo
from sot.motion.feet.contacts import Phase, support_polygon
from sot.motion.trajectory import Motion
from sot.polygon import Polygon
from sot.robots.robot import Robot
from sot.servo.shifted_posture import shifted_posture
from sot.servo.soft_feet import refuse_soft_feet

Array = np.ndarray

STANDING_FOOT = "left_foot"
LIFT_RATIO = 0.06
"""Height of the other foot, of the centre of mass's."""
STIFFNESS_RATIO = 5.5
"""Stiffness of a foot about x and y in weights times metres of height, 2,500 N m/rad for the HRP-2-like robot, and …"""
VERTICAL_RATIO = 170.0
"""… along z in weights a metre of height, 125,000 N/m for it."""


@dataclass(frozen=True, eq=False)
class Stance:
    """How a robot stands.

    Attributes:
        robot: the robot.
        support: one of `sot.servo.identified.SUPPORTS`.
        q: posture (nq,).
        feet: that stand, on the floor.
        pivot: middle of their bushes (3,) [m]; the centre of mass is above.
        length: height of the centre of mass above it [m].
        reach: distance from under the pivot to the edge of the support, along x and y, the nearer side (2,) [m].
        edges: of the support.
    """

    robot: Robot
    support: str
    q: Array
    feet: dict[str, pin.SE3]
    pivot: Array
    length: float
    reach: Array
    edges: Polygon

    def motion(self, duration: float, rate: float) -> Motion:
        """Standing like this."""
        still = Motion.standing(self.robot, duration, rate)
        com = pin.centerOfMass(self.robot.model, self.robot.model.createData(), self.q)
        count = len(still.q)
        return replace(
            still,
            q=np.tile(self.q, (count, 1)),
            com=np.tile(com, (count, 1)),
            zmp=np.tile(com[:2], (count, 1)),
            phases=(Phase(0.0, still.duration, self.feet),),
        )


def stance_of(robot: Robot, support: str) -> Stance:
    """A robot at rest on both feet or on one, the other lifted."""
    data = robot.model.createData()
    standing = robot.feet if support == "double" else (STANDING_FOOT,)
    com = pin.centerOfMass(robot.model, data, robot.rest).copy()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    feet = {foot: data.oMf[robot.point(foot)].copy() for foot in standing}
    pivot = np.mean([at.act(bush_position(robot, foot)) for foot, at in feet.items()], axis=0)
    lifts = {foot: np.array([0.0, 0.0, LIFT_RATIO * com[2]]) for foot in robot.feet if foot not in standing}
    q = shifted_posture(robot, robot.rest, pivot[:2] - com[:2], lifts)
    length = float(pin.centerOfMass(robot.model, data, q)[2] - pivot[2])
    edges = support_polygon(robot, Phase(0.0, 1.0, feet))
    room = edges.offsets - edges.normals @ pivot[:2]
    along = np.abs(edges.normals).T  # distance along an axis to the nearest edge's line
    reach = np.array([np.min(room[axis > 1e-6] / axis[axis > 1e-6]) for axis in along])
    return Stance(robot, support, q, feet, pivot, length, reach, edges)


def usual_compliance(robot: Robot) -> FootCompliance:
    """Bushes that suit a robot's weight and height as 2,500 N m/rad suit the HRP-2-like one."""
    weight = robot.mass * GRAVITY
    length = stance_of(robot, "double").length
    turning = STIFFNESS_RATIO * weight * length
    return FootCompliance(turning, turning, VERTICAL_RATIO * weight / length)


def world_of(
    stance: Stance,
    compliance: FootCompliance,
    period: float,
    pushes: Sequence[Push] = (),
    sensors: Sensors | None = None,
) -> World:
    """A world with the robot on servos and bushes, at rest in its stance.

    Raises:
        InputError: the bushes are too soft to stand on.
    """
    refuse_soft_feet(compliance, stance.motion(1.0, 10.0))
    hardware = Hardware(Servo.of(stance.robot), compliance, sensors or Sensors())
    world = World(stance.robot, period, pushes=pushes, hardware=hardware)
    world.reset(stance.q)
    return world
