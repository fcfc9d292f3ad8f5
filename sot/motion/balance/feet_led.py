"""A motion led by its feet: their paths are given, the centre of mass keeps balance, the posture stays near rest."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.control.tick import Tick
from sot.errors import InputError
from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.programme import plan_balance
from sot.motion.body.coordinates import from_configuration, to_pinocchio
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import Phase
from sot.motion.feet.support import supports
from sot.motion.feet.swing import FootPath
from sot.motion.footing import footing_on
from sot.motion.ground import UP, Ground
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface

Array = NDArray[np.float64]

NEWTON_STEPS = 4  # of inverse kinematics at each knot, from the knot before
REACH_TOLERANCE = 1e-2  # m and rad, before the last Newton step, of what is within reach
RANGE_TOLERANCE = 1e-3  # rad, by which a joint may be beyond its range
HOMEWARD_SHARE = (
    0.1  # of the way to the rest posture in a Newton step, within the null space of feet and centre of mass
)


def feet_led(
    robot: Robot,
    phases: Sequence[Phase],
    paths: Mapping[str, FootPath],
    period: float,
    rate: float,
    surface: Surface = FLOOR,
) -> Motion:
    """The motion of a robot whose feet follow paths, its waist upright, its centre of mass at the height of rest.

    Args:
        robot: who moves.
        phases: which feet carry when, from time zero on, on the level floor.
        paths: foot -> where it is to be at T knots over the level floor.
        period: time between knots [s].
        rate: samples per second of the motion [Hz].
        surface: of the world that phases and paths are laid onto; the centre of mass rises with it.

    Raises:
        InputError: legs do not reach, or feet would stand beyond the edge of the surface.
    """
    ground = Ground(surface)
    phases, paths = ground.laid_phases(robot, phases), ground.laid_paths(paths)
    rest = Tick(robot)
    middle = np.mean([path.position[:, :2] for path in paths.values()], axis=0)
    wanted = rest.com[:2] + middle - middle[0]
    count = len(middle)
    still = Centroidal(np.tile(rest.com, (count, 1)), np.zeros((count, 6)), np.zeros((count, 6)), robot.mass)
    com = plan_balance(still, wanted, supports(robot, phases), period).com.knots
    q = _configurations_following(robot, np.column_stack([com, still.com[:, 2] + ground.height(com)]), paths, ground)
    spline = Spline.through(from_configuration(q), period)
    times = np.arange(round(spline.duration * rate) + 1) / rate
    sampled = to_pinocchio(*(spline(times, order) for order in range(3)))
    state = Centroidal.along(robot, *sampled)
    return Motion(
        robot,
        rate,
        *sampled,
        com=state.com,
        com_velocity=state.velocity,
        com_acceleration=state.acceleration,
        zmp=replace(state, com=state.com - np.outer(ground.height(state.com[:, :2]), UP)).zmp(),
        momentum=state.momentum[:, 3:],
        phases=tuple(phases),
    )


def _configurations_following(robot: Robot, com: Array, paths: Mapping[str, FootPath], ground: Ground) -> Array:
    """Configurations (T, nq): Newton steps on CoM, waist and feet; the joints go home in their null space.

    Raises:
        InputError: they would be beyond the joints' ranges, or legs do not reach.
    """
    tick, nothing = Tick(robot), np.zeros(robot.nv)
    q = footing_on(robot, dict.fromkeys(robot.feet, ground.surface)).q
    out = np.empty((len(com), robot.nq))
    for k, centre in enumerate(com):
        for _ in range(NEWTON_STEPS):
            tick.update(0.0, q, nothing)
            waist = tick.frame("waist")
            jacobians, errors = [tick.com_jacobian, waist.jacobian[3:]], [centre - tick.com, pin.log3(waist.rotation.T)]
            for foot, path in paths.items():
                frame = tick.frame(foot)
                jacobians.append(frame.jacobian)
                errors += [path.position[k] - frame.position, pin.log3(path.rotation[k] @ frame.rotation.T)]
            J, error = np.vstack(jacobians), np.concatenate(errors)
            inverse = np.linalg.pinv(J, rcond=1e-6)
            home = np.concatenate([np.zeros(6), HOMEWARD_SHARE * (robot.rest[7:] - q[7:])])
            q = pin.integrate(robot.model, q, inverse @ (error - J @ home) + home)
        beyond = np.maximum(robot.lower - q[7:], q[7:] - robot.upper)
        if not np.abs(error).max() < REACH_TOLERANCE or beyond.max() > RANGE_TOLERANCE:
            raise InputError(f"{robot.label} cannot walk on {ground.surface.name} like that: its legs do not reach")
        out[k] = q
    return out
