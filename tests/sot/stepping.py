"""A small motion that steps: weight onto one foot, the other forward and down again, and the same with the other."""

import numpy as np
import pinocchio as pin

from sot.motion.balance import plan_balance
from sot.motion.centroidal import Centroidal
from sot.motion.contacts import Phase, planted
from sot.motion.coordinates import from_configuration, to_pinocchio
from sot.motion.spline import Spline
from sot.motion.support import supports
from sot.motion.trajectory import Motion
from sot.robot import Robot
from sot.tick import Tick

Array = np.ndarray

PERIOD = 0.02
AHEAD = np.array([1.0, 0.0, 0.0])
FIRST, STAND, SWING, LAST = 1.2, 0.5, 0.6, 1.2
"""Times [s]: before the first step, between steps, in the air, after the last."""


def stepping_motion(robot: Robot, stride: float = 0.05, height: float = 0.04, rate: float = 1000.0) -> Motion:
    """The robot steps forward with its right foot, then with its left.

    Args:
        robot: who steps.
        stride: length of a step [m].
        height: of the foot's path [m].
        rate: of the motion [Hz].
    """
    phases = _phases(robot, stride)
    times = np.arange(round(phases[-1].end / PERIOD) + 1) * PERIOD
    rest = Tick(robot)
    count = len(times)
    still = Centroidal(np.tile(rest.com, (count, 1)), np.zeros((count, 6)), np.zeros((count, 6)), robot.mass)
    wanted = np.linspace(0.0, stride, count)[:, None] * (1.0, 0.0) + rest.com[:2]
    com = plan_balance(still, wanted, supports(robot, phases), PERIOD).com.knots
    q = _follow(robot, np.column_stack([com, still.com[:, 2]]), [_feet(phases, t, height) for t in times])
    spline = Spline.through(from_configuration(q), PERIOD)
    fine = np.arange(round(spline.duration * rate) + 1) / rate
    sampled = to_pinocchio(*(spline(fine, order) for order in range(3)))
    state = Centroidal.along(robot, *sampled)
    centre = state.com, state.velocity, state.acceleration, state.zmp(), state.momentum[:, 3:]
    return Motion(robot, rate, *sampled, *centre, phases)


def _phases(robot: Robot, stride: float) -> tuple[Phase, ...]:
    here = dict(planted(robot, 0.0)[0].feet)
    phases, end = [Phase(0.0, FIRST, dict(here))], FIRST
    for foot in reversed(robot.feet):
        phases.append(Phase(end, end + SWING, {name: pose for name, pose in here.items() if name != foot}))
        here[foot] = pin.SE3(here[foot].rotation, here[foot].translation + stride * AHEAD)
        end += SWING
        phases.append(Phase(end, end + STAND, dict(here)))
        end += STAND
    return (*phases[:-1], Phase(phases[-1].start, end - STAND + LAST, dict(here)))


def _feet(phases: tuple[Phase, ...], t: float, height: float) -> dict[str, Array]:
    """Position of each foot at a time [m]; a foot leaves and lands at rest, without acceleration."""
    index = max(k for k, phase in enumerate(phases) if phase.start <= t + 1e-9)
    places = {foot: pose.translation for foot, pose in phases[index].feet.items()}
    if 0 < index < len(phases) - 1:
        for foot in phases[index - 1].feet.keys() - phases[index].feet.keys():
            x = (t - phases[index].start) / (phases[index].end - phases[index].start)
            before, after = (phases[k].feet[foot].translation for k in (index - 1, index + 1))
            share = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
            places[foot] = before + share * (after - before) + [0.0, 0.0, height * 64.0 * (x * (1.0 - x)) ** 3]
    return places


def _follow(robot: Robot, com: Array, feet: list[dict[str, Array]]) -> Array:
    """Configurations (T, nq) with the CoM and the feet there, waist and feet level, joints near rest."""
    tick, q, out = Tick(robot), robot.rest.copy(), []
    for centre, places in zip(com, feet, strict=True):
        for _ in range(4):
            tick.update(0.0, q, np.zeros(robot.nv))
            jacobians = [tick.com_jacobian, tick.frame("waist").jacobian[3:]]
            errors = [centre - tick.com, pin.log3(tick.frame("waist").rotation.T)]
            for foot, place in places.items():
                frame = tick.frame(foot)
                jacobians.append(frame.jacobian)
                errors.append(np.concatenate([place - frame.position, pin.log3(frame.rotation.T)]))
            J, e = np.vstack(jacobians), np.concatenate(errors)
            inverse = np.linalg.pinv(J, rcond=1e-6)
            home = np.concatenate([np.zeros(6), robot.rest[7:] - q[7:]])
            q = pin.integrate(robot.model, q, inverse @ e + 0.1 * (home - inverse @ (J @ home)))
        out.append(q)
    return np.array(out)
