"""The demonstration's clock: exact, smooth, and at rest where it says."""

import numpy as np
import pytest

from sot.behaviours.manipulation.clock import DemonstrationClock
from sot.control.pose import Pose


def played(clock, times, stop_at=np.inf, resume_at=np.inf):
    rows = []
    for t in times:
        clock.running = not stop_at <= t < resume_at
        clock.advance(t)
        rows.append((clock.time, clock.rate, clock.acceleration))
    return np.array(rows).T


def test_rate_and_acceleration_are_the_derivatives():
    dt = 1e-4
    times = np.arange(0.0, 2.0, dt)
    s, rate, acceleration = played(DemonstrationClock(20.0), times, 0.8, 1.3)
    assert np.abs(np.diff(s) / dt - 0.5 * (rate[1:] + rate[:-1])).max() < 1e-4
    assert np.abs(np.diff(rate) / dt - 0.5 * (acceleration[1:] + acceleration[:-1])).max() < 1e-2
    assert rate.min() > -1e-9 and rate.max() < 1.0 + 1e-9


def test_the_step_does_not_change_the_way():
    fine = played(DemonstrationClock(20.0), np.arange(0.0, 1.001, 0.001))[:, -1]
    coarse = played(DemonstrationClock(20.0), np.arange(0.0, 1.001, 0.01))[:, -1]
    assert fine == pytest.approx(coarse, abs=1e-9)


def test_it_comes_to_rest_where_it_says():
    clock = DemonstrationClock(20.0)
    played(clock, np.arange(0.0, 0.07, 0.001))
    told, clock.running = clock.stopping_time, False
    clock.advance(5.0)
    assert clock.time == pytest.approx(told, abs=1e-9) and clock.rate == pytest.approx(0.0, abs=1e-9)


def test_a_reference_keeps_its_derivatives():
    clock, dt = DemonstrationClock(20.0), 1e-4

    def path(s):
        x = np.array([np.sin(s), s**2, 0.0])
        v = np.array([np.cos(s), 2 * s, 0.0])
        a = np.array([-np.sin(s), 2.0, 0.0])
        return Pose(x, np.eye(3), np.concatenate([v, np.zeros(3)]), np.concatenate([a, np.zeros(3)]))

    reference = clock.pose(path)
    rows = []
    for t in np.arange(0.0, 0.6, dt):
        clock.running = t < 0.3
        clock.advance(t)
        rows.append(reference(t))
    x, v, a = (np.array([getattr(row, name)[:3] for row in rows]) for name in ("position", "velocity", "acceleration"))
    assert np.abs(np.diff(x, axis=0) / dt - 0.5 * (v[1:] + v[:-1])).max() < 1e-4
    assert np.abs(np.diff(v, axis=0) / dt - 0.5 * (a[1:] + a[:-1])).max() < 2e-2
