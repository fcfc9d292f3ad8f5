"""Sine sweeps: the response of the zero-moment point to the reference of the centre of mass, Kim & Oh 4.2."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, cos, pi

import numpy as np

from scenarios.kimoh2013.damping.stance import Stance, world_of
from sim.hardware.floor_contacts import floor_contacts
from sot.errors import InputError
from sot.hardware.compliance import FootCompliance
from sot.servo.identified import PLANES
from sot.servo.pendulum import Pendulum
from sot.servo.pendulum_fit import FrequencyResponse, fit_pendulum, sine_coefficients
from sot.servo.stabiliser import Stabiliser
from sot.servo.sway_modes import FloorContact

Array = np.ndarray

SAMPLING_RATE = 200.0
"""Of the commands and of what is measured [Hz], the paper's."""
FREQUENCIES = tuple(np.geomspace(0.2, 10.0, 13).tolist())
"""Of the coarse sweep [Hz]."""
RESONANCE_OFFSETS = (-2.0, -1.0, 0.0, 1.0, 2.0)
"""Frequencies that are added around the resonance f_n that was fitted, as offsets in ζ f_n, half its bandwidth."""
LEAST_HALF_BANDWIDTH = 0.02
"""Least ζ that such offsets go by: a fit to frequencies off the resonance may find none."""
MAX_REFINEMENTS = 3
"""How often frequencies are added at most."""
REST_S = 2.0
"""Time before the first sine, and after one that was broken off [s]."""
MIN_RAMP_S = 1.0
"""Shortest time in which a sine comes up [s]; it takes a cycle at least."""
WINDOW_CYCLES, MIN_WINDOW_S = 1, 2.0
"""Least cycles and time over which a sine is measured [s]; it is measured until …"""
STEADY, MAX_WINDOWS = 0.02, 8
"""… two windows agree to this share: at first the robot also sways as if it had been pushed."""
AIM_SHARE = 0.25
"""Amplitude of the zero-moment point that is aimed at, of the way to the edge of the sole."""
MIN_SHARE, MAX_SHARE = 0.06, 0.4
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
        distortion: rms of all but the sine, over the sine's (k,).
    """

    plane: str
    response: FrequencyResponse
    amplitude: Array
    zmp_amplitude: Array
    distortion: Array


class SwayingRobot:
    """A robot in a world, whose centre of mass is led along one axis as a damping controller would lead it.

    Args:
        stance: how it stands.
        compliance: of its feet.
        plane: in which it is led.
    """

    def __init__(self, stance: Stance, compliance: FootCompliance, plane: str) -> None:
        self.axis, self.stance = PLANES.index(plane), stance
        self.period = 1.0 / SAMPLING_RATE
        self._world = world_of(stance, compliance, self.period)
        self._controller = Stabiliser(stance.motion(1.0, SAMPLING_RATE), self.period, damping=self._lead)
        self._shift, self._zmp = np.zeros(2), np.zeros(2)

    def _lead(self, t: float, zmp: Array) -> Array:
        self._zmp = zmp
        return self._shift

    def rest(self) -> None:
        """Let it stand still for a while."""
        for _ in range(round(REST_S * SAMPLING_RATE)):
            self.step(0.0)

    def floor_contacts(self) -> dict[str, FloorContact]:
        """The floor under the feet that stand."""
        return floor_contacts(self._world.model, self._world.data, self.stance.robot)

    def step(self, shift: float) -> float:
        """Command a shift [m] for one period; returns the zero-moment point before it [m].

        Raises:
            InputError: no foot carries anything: the robot fell.
        """
        self._shift[self.axis] = shift
        world = self._world
        self._world.step(self._controller(world.time, *world.state(), world.readings()))
        zmp = float(self._zmp[self.axis])
        if not np.isfinite(zmp):
            raise InputError(f"{self.stance.robot.label} fell over while it was being identified")
        return zmp


def sweep(
    stance: Stance, compliance: FootCompliance, plane: str, tell: Callable[[float], object] = lambda share: None
) -> Sweep:
    """Sweep one case: coarsely, then around the resonance that a pendulum fitted to what was measured has.

    The amplitude of the first sine follows from the gain at rest of an infinitely stiff robot, its height; each further
    one from the gain at the frequency before, and around the resonance from the fit.

    Args:
        stance: how the robot stands.
        compliance: of its feet.
        plane: one of `PLANES`.
        tell: told which share is done.

    Raises:
        InputError: the robot falls over, or no amplitude suits.
    """
    robot = SwayingRobot(stance, compliance, plane)
    robot.rest()
    gain, sines = 1.0, {}
    total = len(FREQUENCIES) + len(RESONANCE_OFFSETS)
    for frequency in FREQUENCIES:
        sines[frequency] = _suitable_sine(robot, plane, frequency, gain)
        gain = abs(sines[frequency].ratio)
        tell(len(sines) / total)
    for _ in range(MAX_REFINEMENTS):
        pendulum = fit_pendulum(_response(sines, stance.length), stance.robot.mass, stance.length)
        missing = missing_frequencies(pendulum, sorted(sines))
        if not missing:
            break
        for frequency, value in zip(missing, pendulum.response(np.array(missing)), strict=True):
            robot.rest()
            expected = abs(value) / stance.length
            sines[frequency] = _suitable_sine(robot, plane, frequency, expected, pendulum.pole)
            tell(min(len(sines) / total, 1.0))
    ascending = [sines[frequency] for frequency in sorted(sines)]
    amplitude, ratio, distortion = (
        np.array([getattr(sine, name) for sine in ascending]) for name in ("amplitude", "ratio", "distortion")
    )
    return Sweep(plane, _response(sines, stance.length), amplitude, np.abs(ratio) * amplitude, distortion)


def missing_frequencies(pendulum: Pendulum, measured: Sequence[float]) -> list[float]:
    """Frequencies around a pendulum's resonance to be measured [Hz]; none if it lies amid measured ones [Hz].

    A damping ratio is seen within half a bandwidth of the resonance alone: there both sides must have been measured.
    """
    resonance = pendulum.natural_frequency / (2.0 * pi)
    half = max(pendulum.damping_ratio, LEAST_HALF_BANDWIDTH)
    offsets = (np.array(measured) / resonance - 1.0) / half
    near = offsets[np.abs(offsets) <= 1.5]
    if np.any(near <= 0.0) and np.any(near >= 0.0) and len(near) > 1:
        return []
    return [float(resonance * (1.0 + half * offset)) for offset in RESONANCE_OFFSETS]


def _response(sines: Mapping[float, "_MeasuredSine"], length: float) -> FrequencyResponse:
    """What was measured, by ascending frequency."""
    frequency = sorted(sines)
    return FrequencyResponse(np.array(frequency), np.array([sines[one].ratio * length for one in frequency]))


def _suitable_sine(
    robot: SwayingRobot, plane: str, frequency: float, gain: float, pole: complex | None = None
) -> "_MeasuredSine":
    """A sine that moves the zero-moment point enough and leaves the sole flat; tried until its amplitude suits.

    Args:
        robot: that sways.
        plane: for the message.
        frequency: of the sine [Hz].
        gain: that is expected, zero-moment point over reference.
        pole: of the sway, if it is known: near resonance what a sine begins with dies out too slowly to wait for.

    Raises:
        InputError: no amplitude suits.
    """
    room = float(robot.stance.reach[robot.axis])
    amplitude = AIM_SHARE * room / gain
    for _ in range(MAX_ATTEMPTS):
        found = _measure(robot, frequency, amplitude, MAX_SHARE * room, pole)
        moved = abs(found.ratio) * amplitude
        if found.complete and MIN_SHARE * room <= moved <= MAX_SHARE * room:
            return found
        amplitude *= min(max(AIM_SHARE * room / moved, 0.2), 3.0) if found.complete else 0.3
        if not found.complete:  # what it was shaken up to would break off the next one, too
            robot.rest()
    raise InputError(f"{plane}, {robot.stance.support} support: no amplitude suits at {frequency:.2f} Hz")


@dataclass(frozen=True)
class _MeasuredSine:
    amplitude: float
    ratio: complex
    distortion: float
    complete: bool


def _measure(
    robot: SwayingRobot, frequency: float, amplitude: float, most: float, pole: complex | None
) -> _MeasuredSine:
    """Zero-moment point over reference in one sine, which is broken off where the former moves too far [m].

    Without a pole the last window counts; with one all since the sine came up, and what dies out is fitted, too.
    """
    cycle = 1.0 / frequency
    ramp = max(cycle, MIN_RAMP_S)
    window = round(max(WINDOW_CYCLES, ceil(MIN_WINDOW_S * frequency)) * cycle / robot.period)
    omega = 2.0 * pi * frequency
    count, complete = round(ramp / robot.period), True
    values: list[float] = []
    found: list[complex] = []
    while complete and len(found) < MAX_WINDOWS:
        count += window
        while complete and len(values) < count:
            t = len(values) * robot.period
            values.append(robot.step(amplitude * _smooth_step(t / ramp) * np.sin(omega * t)))
            complete = abs(values[-1]) < 1.3 * most
        begin = max(len(values) - window, 0) if pole is None else min(round(ramp / robot.period), len(values) - 1)
        zmp = np.array(values[begin:])
        times = robot.period * np.arange(begin, len(values))
        found.append(sine_coefficients(times, zmp, frequency, pole))
        if len(found) > 1 and abs(found[-1] - found[-2]) < STEADY * abs(found[-1]):
            break
    end = times[-1] + robot.period
    for k in range(round(cycle / robot.period)):  # and let it die out
        t = k * robot.period
        robot.step(amplitude * _smooth_step(1.0 - t / cycle) * np.sin(omega * (end + t)))
    sine = np.imag(found[-1] * np.exp(1j * omega * times))
    rest = float(np.sqrt(2.0 * np.mean((zmp - zmp.mean() - sine) ** 2)))
    return _MeasuredSine(amplitude, found[-1] / amplitude, rest / max(abs(found[-1]), 1e-12), complete)


def _smooth_step(x: float) -> float:
    """Half a cosine, from 0 at 0 to 1 from 1 on."""
    return 0.5 - 0.5 * cos(pi * min(max(x, 0.0), 1.0))
