"""The largest pushes that a robot on servos and compliant feet survives: by itself, with feet that stay, with steps."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pinocchio as pin
from rich.console import Console
from rich.table import Table

from scenarios.kimoh2013.damping.push_runs import IMPULSE_STEP, SENSORS, force_along, usual_push
from scenarios.kimoh2013.damping.stance import Stance, stance_of, world_of
from scenarios.kimoh2013.damping.sweep import SAMPLING_RATE
from scenarios.stacks import catching_stack, stepping_schedule
from sim.loop import run
from sim.push import Push
from solvers import Cascade
from sot.control.controller import Controller
from sot.hardware.compliance import FootCompliance
from sot.hardware.sensors import sensor_preset
from sot.hardware.servo import Servo
from sot.motion.trajectory import Motion
from sot.polygon import Polygon
from sot.robots.robot import Robot
from sot.servo.stabiliser import DcmGains, Stabiliser
from sot.servo.stacks.catching_stack import CatchingStack

NOTHING, FEET, STEPS = "nothing", "feet that stay", "steps"
WAYS = (NOTHING, FEET, STEPS)
"""What keeps the robot up: the plan alone, the divergent component by feet that stay, and by steps besides."""
DIRECTIONS: Mapping[str, tuple[int, float]] = {"forward": (0, 1.0), "back": (0, -1.0), "sideways": (1, 1.0)}
"""Axis and sign of a push."""
WATCHED_S = 3.0
"""How long a pushed robot is watched: one that stands then has its steps behind it [s]."""
LEAST_SCALE = 0.1
"""Smallest push that is tried, of the usual one."""


def stabiliser_of(way: str, motion: Motion, compliance: FootCompliance) -> Stabiliser:
    """The position controller of a way to stay up, at `SAMPLING_RATE`."""
    period = 1.0 / SAMPLING_RATE
    if way == NOTHING:
        return Stabiliser(motion, period)
    robot, catching = motion.robot, None
    if way == STEPS:
        stack, schedule = catching_stack(robot, motion), stepping_schedule(robot, motion)
        catching = CatchingStack(Controller(robot, stack, Cascade(), period, schedule), motion)
    return Stabiliser(motion, period, compliance, Servo.of(robot), DcmGains(), catching=catching)


def stands_after(stance: Stance, compliance: FootCompliance, way: str, push: Push, seed: int) -> bool:
    """Whether a pushed robot has not fallen, and has its centre of mass over its feet, wherever they are now.

    Args:
        stance: how it stands before.
        compliance: of its feet.
        way: one of `WAYS`.
        push: the push.
        seed: of the noise of its sensors.
    """
    robot, motion = stance.robot, stance.motion(push.end + WATCHED_S, SAMPLING_RATE)
    world = world_of(stance, compliance, 1.0 / SAMPLING_RATE, [push], sensor_preset(SENSORS, seed))
    done = run(stabiliser_of(way, motion, compliance), world, motion)
    q, data = done.log.trimmed().q[-1][: robot.nq], robot.model.createData()
    com = pin.centerOfMass(robot.model, data, q)
    pin.framesForwardKinematics(robot.model, data, q)
    places = {foot: data.oMf[robot.point(foot)] for foot in robot.feet}
    corners = [place.act(corner)[:2] for foot, place in places.items() for corner in robot.sole(foot)]
    return done.fell_at_s is None and float(Polygon.hull(np.array(corners)).margin(com[:2])) > 0.0


def largest_impulse(stands: Callable[[float, int], bool], start: float, seeds: int) -> float:
    """Largest impulse that all seeds survive, on a grid of 6 %, up to which the first one survives coarser steps.

    Args:
        stands: whether the robot stands after an impulse [N s], with a seed.
        start: impulse to begin with [N s].
        seeds: how many there are.
    """
    impulse, least = start, LEAST_SCALE * start
    if stands(impulse, 0):
        while stands(impulse * IMPULSE_STEP, 0):
            impulse *= IMPULSE_STEP
    else:
        while impulse > least and not stands(impulse, 0):
            impulse /= IMPULSE_STEP
    for step in (IMPULSE_STEP**0.5, IMPULSE_STEP**0.25):
        if stands(impulse * step, 0):
            impulse *= step
    while impulse > least and not all(stands(impulse, seed) for seed in range(1, seeds)):
        impulse /= IMPULSE_STEP**0.25
    return impulse


def largest_push_figures(
    robot: Robot,
    compliance: FootCompliance,
    axes: frozenset[int],
    seeds: int,
    tell: Callable[[str, float | None], object],
) -> dict[str, dict[str, float]]:
    """Direction -> way -> largest impulse that is survived in double support [N s].

    Args:
        robot: the robot.
        compliance: of its feet.
        axes: of the pushes.
        seeds: of noise and beginning of the push.
        tell: told of the progress.
    """
    stance, figures = stance_of(robot, "double"), dict[str, dict[str, float]]()
    for k, (direction, (axis, sign)) in enumerate(DIRECTIONS.items()):
        if axis not in axes:
            continue
        figures[direction] = found = {}
        start = usual_push(stance, axis, 0).impulse
        for way in WAYS:
            tell(f"pushing {direction} to the limit, {way}", k / len(DIRECTIONS))

            def stands(impulse: float, seed: int, way: str = way, axis: int = axis, sign: float = sign) -> bool:
                push = usual_push(stance, axis, seed)
                harder = replace(push, force=force_along(axis, sign * impulse / push.duration))
                return stands_after(stance, compliance, way, harder, seed)

            found[way] = start = largest_impulse(stands, start, seeds)
    return figures


def print_largest_pushes(figures: Mapping[str, Mapping[str, float]], console: Console) -> None:
    """Print a row a direction, with the ratios to what stands by itself."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column("survived, N s")
    for way in WAYS:
        table.add_column(way, justify="right")
    for direction, found in figures.items():
        told = [f"{found[way]:.0f} ({found[way] / found[NOTHING]:.2f} x)" for way in (FEET, STEPS)]
        table.add_row(direction, f"{found[NOTHING]:.0f}", *told)
    console.print(table)
