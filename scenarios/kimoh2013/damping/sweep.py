"""Sine sweeps: the response of the zero-moment point to the reference of the centre of mass, Kim & Oh 4.2."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from scipy.interpolate import CubicSpline

from scenarios.kimoh2013.damping.stance import PLANES, Stance, world_of
from sot.errors import InputError
from sot.hardware.compliance import FootCompliance
from sot.hardware.readings import measured_zmp
from sot.hardware.servo import JointTargets
from sot.servo.pendulum_fit import FrequencyResponse, sine_coefficients
from sot.servo.posture_shift import PostureShift

Array = np.ndarray

SAMPLING_RATE = 200.0
"""Of the commands and of what is measured [Hz], the paper's."""
FREQUENCIES = tuple(np.geomspace(0.2, 10.0, 19).tolist())
"""[Hz]."""
REST_S = 2.0
"""Time before the first sine [s]."""
MIN_RAMP_S = 1.0
"""Shortest time in which a sine comes up [s]; it takes a cycle at least."""
MEASURED_CYCLES, MIN_MEASURED_S = 2, 3.0
"""Least cycles and time over which a sine is measured [s]."""
POSTURES = 31
"""Postures that are computed beforehand, over all shifts."""
AIM_SHARE = 0.3
"""Amplitude of the zero-moment point that is aimed at, of the way to the edge of the sole."""
MIN_SHARE, MAX_SHARE = 0.06, 0.55
"""Amplitudes with which a measurement counts."""
MAX_ATTEMPTS = 8


@dataclass(frozen=True)
class Sweep:
    """What a sweep found.

    Attributes:
        plane: one of `PLANES`.
        response: zero-moment point over the angle of the reference [m/rad].
        amplitude: of the reference at each frequency (k,) [m].
        zmp_amplitude: of the zero-moment point (k,) [m].
        distortion: rms of what is no sine of that frequency, of the rms of the sine (k,).
    """

    plane: str
    response: FrequencyResponse
    amplitude: Array
    zmp_amplitude: Array
    distortion: Array


class SwayingRobot:
    """A robot in a world, whose centre of mass is led along one axis.

    Args:
        stance: how it stands.
        compliance: of its feet.
        plane: in which it is led.
    """

    def __init__(self, stance: Stance, compliance: FootCompliance, plane: str) -> None:
        self.axis, self.stance = PLANES.index(plane), stance
        self.period = 1.0 / SAMPLING_RATE
        self._world = world_of(stance, compliance, self.period)
        self._posture = _shifted_postures(stance, self.axis)
        self._rate = self._posture.derivative()

    def step(self, position: float, velocity: float) -> float:
        """Command a shift [m] at a rate [m/s] for one period; returns the zero-moment point before it [m].

        Raises:
            InputError: no foot carries anything: the robot fell.
        """
        zmp = measured_zmp(self._world.readings().foot_wrench, self.stance.feet)[self.axis]
        self._world.step(JointTargets(self._posture(position), velocity * self._rate(position)))
        if not np.isfinite(zmp) and self._world.time > REST_S:
            raise InputError(f"{self.stance.robot.label} fell over while it was being identified")
        return float(zmp - self.stance.pivot[self.axis])


def sweep(
    stance: Stance, compliance: FootCompliance, plane: str, tell: Callable[[float], object] = lambda share: None
) -> Sweep:
    """Sweep one case.

    The amplitude of the first sine follows from the gain at rest of an infinitely stiff robot, its height; each further
    one from the gain at the frequency before. Where the zero-moment point moves too little or too much for the sole to
    stay flat, the frequency is tried again.

    Args:
        stance: how the robot stands.
        compliance: of its feet.
        plane: one of `PLANES`.
        tell: told which share is done.

    Raises:
        InputError: the robot falls over, or no amplitude suits.
    """
    robot = SwayingRobot(stance, compliance, plane)
    room = float(stance.reach[robot.axis])
    for _ in range(round(REST_S * SAMPLING_RATE)):
        robot.step(0.0, 0.0)
    gain, rows = 1.0, []
    for k, frequency in enumerate(FREQUENCIES):
        amplitude = AIM_SHARE * room / gain
        for _ in range(MAX_ATTEMPTS):
            found = _measure(robot, frequency, amplitude, MAX_SHARE * room)
            gain = abs(found.ratio)
            if found.complete and MIN_SHARE * room <= gain * amplitude <= MAX_SHARE * room:
                break
            amplitude *= min(max(AIM_SHARE * room / (gain * amplitude), 0.2), 3.0) if found.complete else 0.3
        else:
            raise InputError(f"{plane}, {stance.support} support: no amplitude suits at {frequency:.2f} Hz")
        rows.append((found.ratio * stance.length, amplitude, gain * amplitude, found.distortion))
        tell((k + 1) / len(FREQUENCIES))
    value, amplitudes, zmp, distortion = (np.array(column) for column in zip(*rows, strict=True))
    return Sweep(plane, FrequencyResponse(np.array(FREQUENCIES), value), amplitudes, zmp, distortion)


@dataclass(frozen=True)
class _MeasuredSine:
    ratio: complex
    distortion: float
    complete: bool


def _measure(robot: SwayingRobot, frequency: float, amplitude: float, most: float) -> _MeasuredSine:
    """Zero-moment point over reference in one sine, which is broken off where the former moves too far [m]."""
    cycle = 1.0 / frequency
    ramp = max(cycle, MIN_RAMP_S)
    total = ramp + max(MEASURED_CYCLES, ceil(MIN_MEASURED_S * frequency)) * cycle
    omega = 2.0 * pi * frequency
    times = np.arange(round(total / robot.period)) * robot.period
    values, complete = np.zeros(len(times)), True
    for k, t in enumerate(times):
        values[k] = robot.step(*_sine(amplitude, omega, t, *_smooth_step(t, ramp)))
        if abs(values[k]) > 1.3 * most:
            complete, times, values = False, times[: k + 1], values[: k + 1]
            break
    begin = times[-1] + robot.period
    for k in range(round(cycle / robot.period)):  # and let it die out
        risen, rate = _smooth_step(k * robot.period, cycle)
        robot.step(*_sine(amplitude, omega, begin + k * robot.period, 1.0 - risen, -rate))
    inside = times >= (ramp if complete else 0.0)
    zmp = sine_coefficients(times[inside], values[inside], frequency)
    rest = values[inside] - values[inside].mean() - np.imag(zmp * np.exp(1j * omega * times[inside]))
    return _MeasuredSine(zmp / amplitude, float(np.sqrt(2.0 * np.mean(rest**2)) / max(abs(zmp), 1e-12)), complete)


def _sine(amplitude: float, omega: float, t: float, share: float, rate: float) -> tuple[float, float]:
    """A sine of an amplitude of which a share shows, and its rate."""
    sine, cosine = np.sin(omega * t), np.cos(omega * t)
    return amplitude * share * sine, amplitude * (share * omega * cosine + rate * sine)


def _smooth_step(t: float, duration: float) -> tuple[float, float]:
    """Half a cosine from 0 to 1, and its rate [1/s]."""
    if t >= duration:
        return 1.0, 0.0
    angle = pi * t / duration
    return 0.5 - 0.5 * np.cos(angle), 0.5 * pi / duration * np.sin(angle)


def _shifted_postures(stance: Stance, axis: int) -> CubicSpline:
    """Joint angles by the shift of the centre of mass along an axis, as far as the support reaches."""
    robot, shift = stance.robot, PostureShift(stance.robot)
    shifts = 0.7 * float(stance.reach[axis]) * np.linspace(-1.0, 1.0, POSTURES)
    still, direction = np.zeros(robot.nv), np.eye(2)[axis]
    return CubicSpline(shifts, [shift(stance.q, still, x * direction, np.zeros(2), iterations=5)[0][7:] for x in shifts])
