"""A robot whose joints take positions, on soft feet, led by a controller of one's own that feels the floor."""
# python docs/examples/15_servo.py

import numpy as np

from sim import World, run
from sot.hardware import FootCompliance, Hardware, JointTargets, Sensors, Servo
from sot.motion import Motion
from sot.robots import Robot

robot, period = Robot.load("hrp2"), 0.002
stand, yaw = Motion.standing(robot, 2.0, 1.0 / period), robot.joints.index("CHEST0")


class TurnedChest:
    """Turns the chest by 0.2 rad within a second while the feet feel the robot's weight."""

    period, angle = period, 0.0

    def __call__(self, t, q, v, readings):
        position, velocity = stand.joints(t)[0].copy(), np.zeros(robot.na)
        felt = sum(wrench[2] for wrench in readings.foot_wrench.values())
        if felt > 0.5 * 9.81 * robot.mass and self.angle < 0.2:
            velocity[yaw] = 0.2
            self.angle += 0.2 * period
        position[yaw] += self.angle
        return JointTargets(position, velocity)


hardware = Hardware(Servo.of(robot), FootCompliance(roll=2500.0, pitch=2500.0), Sensors())
done = run(TurnedChest(), World(robot, period, hardware=hardware), stand)
