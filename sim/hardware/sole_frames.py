"""Where the soles of feet were in a run, below bushes that gave way."""

import numpy as np
import pinocchio as pin

from sot.hardware.compliance import bush_position, sole_in_foot
from sot.robots.robot import Robot

Array = np.ndarray


def sole_frames(robot: Robot, q: Array, deflection: Array) -> tuple[Array, Array]:
    """Positions (F, T, 3) [m] and rotations (F, T, 3, 3), in the world, of the foot frames as the soles carry them.

    Args:
        robot: the robot.
        q: its configurations (T, nq).
        deflection: of its soles (T, F, 3), as `RunLog.sole_deflection`; (T, 0, 3) for rigid feet.
    """
    data, bushes = robot.model.createData(), [bush_position(robot, foot) for foot in robot.feet]
    positions, rotations = np.empty((len(bushes), len(q), 3)), np.empty((len(bushes), len(q), 3, 3))
    for row, configuration in enumerate(q):
        pin.forwardKinematics(robot.model, data, configuration)
        for k, foot in enumerate(robot.feet):
            at = pin.updateFramePlacement(robot.model, data, robot.point(foot))
            if deflection.shape[1]:
                at = at * sole_in_foot(bushes[k], deflection[row, k])
            positions[k, row], rotations[k, row] = at.translation, at.rotation
    return positions, rotations
