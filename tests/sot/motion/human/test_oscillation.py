"""Planted oscillations are found where, as fast and as far as they are, and nothing is found where there is none."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion.human.oscillation import find_oscillations
from sot.motion.human.scalogram import scalogram
from sot.smooth import minimum_jerk

RATE, SECONDS = 100.0, 24.0
T = np.arange(round(RATE * SECONDS)) / RATE


def slow_motion(rng: np.random.Generator) -> np.ndarray:
    """Large swings, too slow to count."""
    waves = zip(rng.uniform(0.1, 0.4, 3), rng.uniform(0.05, 0.3, 3), rng.uniform(-np.pi, np.pi, 3), strict=True)
    return sum((size * np.sin(2.0 * np.pi * f * T + phase) for size, f, phase in waves), np.zeros_like(T))


def step(rng: np.random.Generator, when: float) -> np.ndarray:
    """A joint that goes elsewhere at once, as a knee does at a footstep."""
    return rng.uniform(-0.3, 0.3) * minimum_jerk((T - when) / rng.uniform(0.3, 0.8))


def coloured_noise(rng: np.random.Generator, exponent: float, rms: float) -> np.ndarray:
    """Noise whose power falls with frequency, f^-exponent."""
    spectrum = np.fft.rfft(rng.standard_normal(len(T)))
    spectrum[1:] *= np.arange(1, len(spectrum)) ** (-0.5 * exponent)
    spectrum[0] = 0.0
    noise = np.fft.irfft(spectrum, len(T))
    return rms * noise / noise.std()


def swing(start: float, end: float, frequency: float, amplitude: float, phase: float) -> np.ndarray:
    on = (start <= T) & (end >= T)
    return np.where(on, amplitude * np.sin(2.0 * np.pi * frequency * T + phase), 0.0)


@pytest.mark.parametrize("seed", range(12))
def test_finds_a_planted_oscillation(seed):
    rng = np.random.default_rng(seed)
    frequency = 2.7 if seed == 0 else rng.uniform(1.0, 6.0)
    length = max(rng.uniform(4.0, 9.0), 6.0 / frequency)
    start = rng.uniform(4.0, SECONDS - 4.0 - length)
    end, amplitude, phase = start + length, rng.uniform(0.05, 0.12), rng.uniform(-np.pi, np.pi)
    steps = step(rng, rng.uniform(0.5, start - 2.0)) + step(rng, rng.uniform(end + 1.0, SECONDS - 1.0))
    q = slow_motion(rng) + steps + swing(start, end, frequency, amplitude, phase) + 0.005 * rng.standard_normal(len(T))
    (found,) = find_oscillations(T, q)
    assert found.frequency == pytest.approx(frequency, abs=0.1)
    assert found.start == pytest.approx(start, abs=0.2)
    assert found.end == pytest.approx(end, abs=0.2)
    assert found.amplitude == pytest.approx(amplitude, rel=0.12)
    middle = 0.5 * (start + end)
    ahead = 2.0 * np.pi * (found.frequency - frequency) * middle + found.phase - phase
    assert abs(np.angle(np.exp(1j * ahead))) < 0.3


def test_finds_two_one_after_the_other_and_a_third_meanwhile():
    q = swing(2.0, 8.0, 2.7, 0.08, 0.0) + swing(14.0, 21.0, 1.4, 0.08, 1.0) + swing(15.0, 20.0, 5.5, 0.05, 2.0)
    found = find_oscillations(T, q + slow_motion(np.random.default_rng(1)))
    assert [round(one.frequency, 1) for one in found] == [2.7, 1.4, 5.5]
    assert [round(one.start) for one in found] == [2, 14, 15]


def test_the_clock_of_a_signal_may_start_anywhere_and_tick_at_any_rate():
    q = swing(6.0, 12.0, 2.7, 0.08, 0.5)
    (found,) = find_oscillations(T, q)
    (later,) = find_oscillations(T + 100.0, q)
    assert (later.start, later.end) == pytest.approx((found.start + 100.0, found.end + 100.0), abs=0.01)
    inside = (found.start < T) & (found.end > T)
    np.testing.assert_allclose(found.swing_at(T)[inside], q[inside], atol=0.01)
    np.testing.assert_allclose(later.swing_at(T + 100.0)[inside], q[inside], atol=0.01)
    faster = np.arange(round(1000.0 * SECONDS)) / 1000.0
    (same,) = find_oscillations(faster, np.interp(faster, T, q))
    assert (same.start, same.end, same.frequency) == pytest.approx((found.start, found.end, found.frequency), abs=0.05)


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.0])
def test_noise_over_slow_motion_seldom_shows_one(exponent):
    noises = (np.random.default_rng([seed, round(exponent)]) for seed in range(15))
    shown = [find_oscillations(T, slow_motion(rng) + coloured_noise(rng, exponent, 0.05), least=0.0) for rng in noises]
    assert sum(map(bool, shown)) <= 2


def test_finds_nothing_in_slow_motion_steps_and_rest():
    rng = np.random.default_rng(0)
    assert find_oscillations(T, slow_motion(rng)) == []
    assert find_oscillations(T, sum(step(rng, when) for when in (3.0, 4.5, 11.0, 16.0, 16.7))) == []
    assert find_oscillations(T, np.full_like(T, 0.3)) == []


def test_what_is_too_small_does_not_count():
    q = swing(6.0, 12.0, 2.7, 0.004, 0.0)
    assert find_oscillations(T, q) == []
    assert len(find_oscillations(T, q, least=0.001)) == 1


@pytest.mark.parametrize("frequency", [0.9, 2.7, 6.0])
def test_the_scalogram_of_a_sine_shows_its_frequency_and_amplitude(frequency):
    seen = scalogram(T, 0.2 * np.sin(2.0 * np.pi * frequency * T), (0.5, 8.0))
    middle = seen.coefficients[:, seen.times.searchsorted(0.5 * SECONDS)]
    best = np.abs(middle).argmax()
    step_between_rows = seen.frequencies[best] / seen.frequencies[best - 1]
    assert abs(np.log(seen.frequencies[best] / frequency)) < 0.6 * np.log(step_between_rows)
    assert abs(middle[best]) == pytest.approx(0.2, rel=0.01)
    np.testing.assert_allclose(seen.power, np.abs(seen.coefficients) ** 2)


@pytest.mark.parametrize(
    ("t", "q", "band", "why"),
    [
        (T, T[:-1], (0.7, 7.0), "as many times as values"),
        (T[:, None], T[:, None], (0.7, 7.0), "as many times as values"),
        (T, np.where(T > 5.0, np.nan, T), (0.7, 7.0), "finite"),
        (T**2, T, (0.7, 7.0), "even steps"),
        (-T, T, (0.7, 7.0), "even steps|or more"),
        (T[:100], T[:100], (0.7, 7.0), "2.9 s or more"),
        (T[:1], T[:1], (0.7, 7.0), "or more"),
        (T, T, (0.7, 40.0), "160 samples a second"),
        (T, T, (7.0, 0.7), "lowest frequency"),
        (T, T, (0.0, 7.0), "lowest frequency"),
    ],
)
def test_says_what_is_wrong(t, q, band, why):
    with pytest.raises(InputError, match=why):
        find_oscillations(t, q, band)
