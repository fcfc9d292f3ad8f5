"""Pushes on a robot that stands on compliant feet, Kim & Oh 5.2: how it sways, and what it survives."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np
from scipy.optimize import least_squares

from scenarios.kimoh2013.damping.stance import Stance, world_of
from scenarios.kimoh2013.damping.sweep import SAMPLING_RATE
from sim.loop import run
from sim.push import Push
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance
from sot.hardware.sensors import sensor_preset
from sot.servo.damping import DampingController, PlaneDesigns
from sot.servo.stabiliser import Stabiliser

Array = np.ndarray
Planes = tuple[PlaneDesigns, PlaneDesigns]

SENSORS = "bmi088"
PUSH_AT_S = 2.0
"""When the push begins at the earliest [s]."""
WATCHED_S = {False: 6.0, True: 3.0}
"""How long the sway is watched, without and with damping [s]."""
PUSH_RATIO = {"double": 0.105, "single": 0.0525}
"""Force of a push in weights: 60 and 30 N for the HRP-2-like robot."""
DURATION_RATIO = 0.355
"""How long it lasts in √(l / g): 0.1 s."""
JITTER_S = 0.3
"""Range of the beginning of the push over the seeds [s]."""
SETTLED = 0.005
"""Deviation of the zero-moment point that counts as settled [m]."""
FITTED_S = 1.5
"""Time of the sway in which its damping ratio is measured [s]."""
SURVIVED_WATCHED_S = 3.0
"""How long a robot is watched that may fall [s]: one that sways back too far needs half of it until it topples."""
IMPULSE_STEP = 1.25
"""Ratio of neighbouring impulses that are tried; the last ratio is its fourth root."""
REPEATED = 5
"""Pushes of a series in the robot's own period: without damping, each finds it swaying that way."""


@dataclass(frozen=True, eq=False)
class Sway:
    """How a pushed robot swayed along the push.

    Attributes:
        time: since the push ended (k,) [s].
        zmp: zero-moment point off its rest (k,) [m].
        fell_at: None if it stands [s]; a robot topples from when its centre of mass leaves the support for good.
    """

    time: Array
    zmp: Array
    fell_at: float | None

    @property
    def settling_time(self) -> float:
        """Until it stays within `SETTLED` [s]; infinite if it fell or sways to the end."""
        if self.fell_at is not None:
            return float("inf")
        out = np.flatnonzero((np.abs(self.zmp) > SETTLED) & (self.time >= 0.0))
        if not len(out):
            return 0.0
        return float("inf") if out[-1] == len(self.time) - 1 else float(self.time[out[-1] + 1])

    @property
    def swing_back(self) -> float:
        """First swing to the other side over the first peak after the push."""
        after = self.zmp[self.time >= 0.0]
        peak = after[0] if abs(after[0]) >= np.abs(after).max() else after[np.argmax(np.abs(after))]
        return float(max(0.0, np.max(-after * np.sign(peak)) / abs(peak)))

    def damping_ratio(self, frequency: float) -> float:
        """Damping ratio of the sway, by a fit of a decaying oscillation, a decaying shift and an offset.

        Args:
            frequency: natural frequency to begin with [Hz].
        """
        inside = (self.time >= 0.0) & (self.time <= FITTED_S)
        t, y = self.time[inside], self.zmp[inside]

        def columns(parameters: Array) -> Array:
            omega, zeta, rate = np.exp(parameters[0]), parameters[1], np.exp(parameters[2])
            turning = omega * sqrt(max(1.0 - zeta**2, 1e-6))
            decay = np.exp(-zeta * omega * t)
            return np.column_stack(
                [decay * np.cos(turning * t), decay * np.sin(turning * t), np.exp(-rate * t), np.ones_like(t)]
            )

        def residual(parameters: Array) -> Array:
            basis = columns(parameters)
            amplitudes, *_ = np.linalg.lstsq(basis, y, rcond=None)
            left: Array = (basis @ amplitudes - y) / np.abs(y).max()
            return left

        omega = np.log(2.0 * pi * frequency)
        bounds = ([omega - 0.7, 0.0, np.log(2.0)], [omega + 0.7, 0.98, np.log(60.0)])
        fits = [least_squares(residual, [omega, zeta, np.log(10.0)], bounds=bounds) for zeta in (0.05, 0.3, 0.6, 0.9)]
        return float(min(fits, key=lambda fit: fit.cost).x[1])


def controller_of(stance: Stance, planes: Planes | None, duration: float) -> Stabiliser:
    """The controller of a stance; without designs, nothing damps."""
    period = 1.0 / SAMPLING_RATE
    single = float(stance.support == "single")
    damping = None if planes is None else DampingController(planes, lambda t: single, stance.reach)
    return Stabiliser(stance.motion(duration, SAMPLING_RATE), period, damping=damping)


def pushed(
    stance: Stance,
    compliance: FootCompliance,
    planes: Planes | None,
    pushes: Sequence[Push],
    watched: float,
    seed: int,
) -> Sway:
    """Push a robot along one axis, once or more, and watch it after the last push.

    Args:
        stance: how it stands.
        compliance: of its feet.
        planes: the damping controllers, if there are any.
        pushes: one after the other.
        watched: time after the last [s].
        seed: of the noise of its sensors.
    """
    push = pushes[-1]
    duration = push.end + watched
    world = world_of(stance, compliance, 1.0 / SAMPLING_RATE, pushes, sensor_preset(SENSORS, seed))
    done = run(controller_of(stance, planes, duration), world, stance.motion(duration, SAMPLING_RATE))
    log = done.log.trimmed()
    axis = int(np.argmax(np.abs(push.force[:2])))
    fell_at = done.fell_at_s
    over = stance.edges.margin(log.com[:, :2]) > 0.0
    if fell_at is None and not over[-1]:
        fell_at = float(log.time[np.flatnonzero(over)[-1]])
    zmp = log.zmp_measured[:, axis]
    rest = zmp[log.time > log.time[-1] - 0.5].mean() if fell_at is None else stance.pivot[axis]
    return Sway(log.time - push.end, (zmp - rest) * np.sign(push.force[axis]), fell_at)


def usual_push(stance: Stance, axis: int, seed: int) -> Push:
    """The push of Figures 16 and 17; its beginning differs from seed to seed."""
    fall = sqrt(stance.length / GRAVITY)
    size = PUSH_RATIO[stance.support] * stance.robot.mass * GRAVITY
    begin = PUSH_AT_S + JITTER_S * float(np.random.default_rng(seed).uniform())
    return Push(begin, force_along(axis, size), DURATION_RATIO * fall)


def series_of(push: Push, count: int, period: float) -> list[Push]:
    """A push, and the same again after each period [s]."""
    return [replace(push, t=push.t + k * period) for k in range(count)]


def survived_impulse(
    stance: Stance,
    compliance: FootCompliance,
    planes: Planes | None,
    axis: int,
    direction: float,
    count: int = 1,
    period: float = 0.0,
) -> float:
    """Largest impulse along or against an axis after which the robot still stands, on a grid of 6 % [N s].

    Args:
        stance: how it stands.
        compliance: of its feet.
        planes: the damping controllers, if there are any.
        axis, direction: of the push.
        count: of pushes of that impulse each.
        period: between their beginnings [s].
    """
    push = usual_push(stance, axis, 0)

    def stands(scale: float) -> bool:
        harder = replace(push, force=force_along(axis, direction * scale * max(push.force)))
        series = series_of(harder, count, period)
        return pushed(stance, compliance, planes, series, SURVIVED_WATCHED_S, 0).fell_at is None

    scale = 1.0
    if stands(scale):
        while stands(scale * IMPULSE_STEP):
            scale *= IMPULSE_STEP
    else:
        while scale > 0.1 and not stands(scale):
            scale /= IMPULSE_STEP
    for step in (IMPULSE_STEP**0.5, IMPULSE_STEP**0.25):
        if stands(scale * step):
            scale *= step
    return scale * push.impulse


def force_along(axis: int, size: float) -> tuple[float, float, float]:
    """A horizontal force along an axis [N]."""
    return (size, 0.0, 0.0) if axis == 0 else (0.0, size, 0.0)
