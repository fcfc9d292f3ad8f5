"""The filter's arithmetic: derivatives by differences, consistency of its covariance, and least squares over all."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.stats import chi2

from sot.estimation import invariant
from sot.estimation.invariant import Belief

GRAVITY, PERIOD, FEET = 9.81, 0.01, 2
SIZE = invariant.FEET + invariant.FOOT * FEET


def some_belief(rng: np.random.Generator, spread: float = 1.0) -> Belief:
    belief = Belief.empty(FEET)
    invariant.retract(belief, spread * rng.uniform(-1, 1, SIZE))
    A = rng.standard_normal((SIZE, SIZE))
    belief.covariance[:] = A @ A.T
    return belief


def copy_of(belief: Belief) -> Belief:
    return Belief(*(part.copy() for part in belief))


def moved(belief: Belief, error: np.ndarray) -> Belief:
    out = copy_of(belief)
    invariant.retract(out, error)
    return out


def error_between(truth: Belief, belief: Belief) -> np.ndarray:
    """The error ξ with truth = Exp(ξ) belief: the inverse of `retract`, by Pinocchio."""
    out = np.empty(SIZE)
    turn = truth.rotation @ belief.rotation.T
    out[:3] = pin.log3(turn)
    J = np.linalg.inv(invariant.left_jacobian(out[:3]))
    out[3:6] = J @ (truth.velocity - turn @ belief.velocity)
    out[6:9] = J @ (truth.position - turn @ belief.position)
    out[9:12], out[12:15] = truth.gyro_bias - belief.gyro_bias, truth.accelerometer_bias - belief.accelerometer_bias
    for k in range(FEET):
        at = invariant.FEET + invariant.FOOT * k
        out[at : at + 3] = J @ (truth.foot_position[k] - turn @ belief.foot_position[k])
        out[at + 3 : at + 6] = pin.log3(truth.foot_rotation[k] @ belief.foot_rotation[k].T)
    return out


def differences(function, step: float = 1e-6) -> np.ndarray:
    """Derivative of a function of the error (n,) at zero, by central differences."""
    columns = [(function(step * e) - function(-step * e)) / (2.0 * step) for e in np.eye(SIZE)]
    return np.stack(columns, axis=1)


def full(F: np.ndarray) -> np.ndarray:
    """The whole transition matrix, of the columns that `predict` returns."""
    return np.hstack([F, np.eye(SIZE)[:, invariant.FEET :]])


def seen_from(truth: Belief, k: int) -> tuple[np.ndarray, np.ndarray]:
    R = truth.rotation
    return R.T @ (truth.foot_position[k] - truth.position), R.T @ truth.foot_rotation[k]


def test_retract_and_its_inverse_agree():
    rng = np.random.default_rng(0)
    belief, error = some_belief(rng), 0.5 * rng.uniform(-1, 1, SIZE)
    assert error_between(moved(belief, error), belief) == pytest.approx(error, abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_left_jacobian_by_differences(seed):
    turn, step = np.random.default_rng(seed).uniform(-1, 1, 3) * (1e-5 if seed == 0 else 1.0), 1e-6
    columns = [pin.log3(pin.exp3(turn + step * e) @ pin.exp3(turn - step * e).T) / (2.0 * step) for e in np.eye(3)]
    assert invariant.left_jacobian(turn) == pytest.approx(np.stack(columns, axis=1), abs=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_transition_by_differences(seed):
    rng = np.random.default_rng(seed)
    belief, gyro, accelerometer = some_belief(rng), 3.0 * rng.uniform(-1, 1, 3), 20.0 * rng.uniform(-1, 1, 3)

    def after(start: Belief) -> Belief:
        end = copy_of(start)
        invariant.predict(end, gyro, accelerometer, GRAVITY, PERIOD)
        return end

    centre = after(belief)
    F = invariant.predict(copy_of(belief), gyro, accelerometer, GRAVITY, PERIOD)
    found = differences(lambda e: error_between(after(moved(belief, e)), centre))
    assert full(F) == pytest.approx(found, abs=1e-7)


def test_a_noisy_reading_acts_as_a_bias_that_lasts_for_it():
    rng = np.random.default_rng(0)
    belief = some_belief(rng)
    belief.covariance[:] = 0.0
    F = invariant.predict(belief, rng.uniform(-1, 1, 3), rng.uniform(-9, 9, 3), GRAVITY, PERIOD)
    variance = rng.uniform(1.0, 2.0, 6)
    invariant.spread(belief, F, variance, np.zeros(SIZE))
    G = F[:, 9:15].copy()
    G[9:15] = 0.0
    assert belief.covariance == pytest.approx(G @ np.diag(variance) @ G.T, abs=1e-12)


@pytest.mark.parametrize("k", range(FEET))
def test_rows_of_a_foot_by_differences(k):
    belief = some_belief(np.random.default_rng(k))
    rows = differences(lambda e: invariant.foot_innovation(belief, k, *seen_from(moved(belief, e), k)))
    assert invariant.foot_rows(belief, k) == pytest.approx(rows, abs=1e-8)


@pytest.mark.parametrize("k", range(FEET))
def test_rows_of_a_place_by_differences(k):
    belief = some_belief(np.random.default_rng(k))
    axes = belief.foot_rotation[k].copy()

    def at(e: np.ndarray) -> np.ndarray:
        truth = moved(belief, e)
        return invariant.place_innovation(belief, k, truth.foot_position[k], truth.foot_rotation[k])

    assert invariant.place_rows(belief, k, axes) == pytest.approx(differences(at), abs=1e-8)


def test_correction_is_that_of_the_textbook():
    rng = np.random.default_rng(1)
    belief = some_belief(rng, 1e-9)
    P, H, innovation, variance = belief.covariance.copy(), rng.uniform(-1, 1, (4, SIZE)), np.full(4, 1e-9), np.ones(4)
    S = H @ P @ H.T + np.eye(4)
    K = P @ H.T @ np.linalg.inv(S)
    expected = moved(belief, K @ innovation)
    assert not invariant.correct(belief, H, innovation, variance, np.inf, 0)
    assert belief.covariance == pytest.approx((np.eye(SIZE) - K @ H) @ P, abs=1e-9)
    assert belief.position == pytest.approx(expected.position, abs=1e-15)


def test_an_innovation_beyond_the_gate_is_taken_for_a_movement_of_that_size():
    rng = np.random.default_rng(1)
    first, at = some_belief(rng, 1e-9), invariant.FEET
    H, variance = invariant.foot_rows(first, 0), np.ones(6)
    S = H @ first.covariance @ H.T + np.eye(6)
    innovation = rng.uniform(1, 2, 6) * 1e-3
    distance = innovation @ np.linalg.solve(S, innovation)
    within, beyond, told = copy_of(first), copy_of(first), copy_of(first)
    assert not invariant.correct(within, H, innovation, variance, 1.001 * distance, at)
    assert invariant.correct(beyond, H, innovation, variance, 0.999 * distance, at)
    told.covariance[range(at, at + 6), range(at, at + 6)] += innovation**2
    invariant.correct(told, H, innovation, variance, np.inf, at)
    assert beyond.covariance == pytest.approx(told.covariance, abs=1e-12)
    assert beyond.position == pytest.approx(told.position, abs=1e-15)


def test_advance_is_predict_and_spread():
    rng = np.random.default_rng(4)
    one, other = (some_belief(np.random.default_rng(4)) for _ in range(2))
    F = invariant.predict(one, np.ones(3), np.ones(3), GRAVITY, PERIOD)
    start, variance, walk = one.covariance.copy(), rng.uniform(1, 2, 6), rng.uniform(1, 2, SIZE)
    invariant.spread(one, F, variance, walk)
    invariant.advance(other, np.ones(3), np.ones(3), GRAVITY, PERIOD, variance, walk)
    assert other.covariance == pytest.approx(one.covariance) and other.position == pytest.approx(one.position)
    noise = np.hstack([F[:, 9:15]])
    noise[9:15] = 0.0
    expected = full(F) @ start @ full(F).T + noise @ np.diag(variance) @ noise.T + np.diag(walk)
    assert one.covariance == pytest.approx(expected)


def test_floor_and_foothold_put_a_foot_where_they_say():
    belief = some_belief(np.random.default_rng(5), 0.1)
    normal, certain = np.array([0.6, 0.0, 0.8]), np.full(3, 1e-12)
    invariant.lay_flat(belief, 1, normal, 0.3, certain)
    assert normal @ belief.foot_position[1] == pytest.approx(0.3, abs=0.02)
    invariant.lay_flat(belief, 1, normal, 0.3, certain)
    assert belief.foot_rotation[1][:, 2] == pytest.approx(normal, abs=1e-3)
    place = np.array([0.1, 0.2, 0.3]), belief.foot_rotation[0].copy()
    for _ in range(5):
        invariant.put_on_foothold(belief, 0, *place, certain)
    assert (place[1].T @ (belief.foot_position[0] - place[0]))[:2] == pytest.approx(np.zeros(2), abs=1e-3)


def test_a_new_foot_is_as_uncertain_as_the_body_and_the_sight_of_it():
    rng = np.random.default_rng(2)
    belief = some_belief(rng)
    sole, variance = (rng.uniform(-1, 1, 3), pin.exp3(rng.uniform(-1, 1, 3))), np.full(6, 0.5)
    invariant.place_foot(belief, 1, *sole, variance)
    H, at = invariant.foot_rows(belief, 1), invariant.FEET + invariant.FOOT
    assert invariant.foot_innovation(belief, 1, *sole) == pytest.approx(np.zeros(6), abs=1e-12)
    assert H @ belief.covariance @ H.T == pytest.approx(np.diag(variance), abs=1e-9)
    invariant.forget_foot(belief, 1)
    assert not belief.covariance[at:].any() and not belief.covariance[:, at:].any()


@pytest.mark.parametrize("angle", [0.0, 1e-10, 0.3, 2.0])
def test_the_least_turn_between_directions(angle):
    a = np.array([0.6, 0.0, 0.8])
    b = pin.exp3(angle * np.array([0.8, 0.0, -0.6])) @ a
    turn = invariant.turn_between(a, b)
    assert pin.exp3(turn) @ a == pytest.approx(b, abs=1e-9)
    assert np.linalg.norm(turn) == pytest.approx(angle, abs=1e-9)


class Simulation:
    """A body that waves over two feet that creep, with sensors of known noise; scaled, all of its noises are."""

    inertial, sight = np.repeat([0.01, 0.3], 3), np.repeat([2e-3, 4e-3], 3)
    walk = np.concatenate([np.zeros(9), np.full(3, 1e-3), np.full(3, 1e-2), np.full(12, 1e-3)]) * np.sqrt(PERIOD)
    start = np.repeat([0.02, 0.05, 0.01, 0.01, 0.2, 0.02, 0.02, 0.02, 0.02], 3)

    def __init__(self, seed: int, scale: float = 1.0) -> None:
        rng = self.rng = np.random.default_rng(seed)
        self.scale, self.truth = scale, Belief.empty(FEET)
        self.truth.position[2], self.truth.foot_position[:, 1] = 0.8, (0.1, -0.1)
        self.belief = moved(self.truth, scale * self.start * rng.standard_normal(SIZE))
        self.belief.covariance[:] = np.diag(np.square(scale * self.start))

    def step(self, tick: int) -> tuple[np.ndarray, np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
        """Move truth and belief on by a tick; returns the readings: gyro, accelerometer, and both feet as seen."""
        truth, rng, scale = self.truth, self.rng, self.scale
        turning = np.array([np.sin(0.1 * tick), 0.7 * np.cos(0.13 * tick), 0.5 * np.sin(0.07 * tick)])
        force = truth.rotation.T @ [np.sin(0.2 * tick), np.cos(0.2 * tick), GRAVITY + np.sin(0.15 * tick)]
        gyro, accelerometer = turning + truth.gyro_bias, force + truth.accelerometer_bias
        invariant.predict(truth, gyro, accelerometer, GRAVITY, PERIOD)
        gyro, accelerometer = np.split(
            np.concatenate([gyro, accelerometer]) + scale * self.inertial * rng.standard_normal(6), 2
        )
        F = invariant.predict(self.belief, gyro, accelerometer, GRAVITY, PERIOD)
        invariant.spread(self.belief, F, np.square(scale * self.inertial), np.square(scale * self.walk))
        invariant.retract(truth, scale * self.walk * rng.standard_normal(SIZE))
        seen = []
        for k in range(FEET):
            position, rotation = seen_from(truth, k)
            error = scale * self.sight * rng.standard_normal(6)
            seen.append((position + error[:3], pin.exp3(error[3:]) @ rotation))
            innovation, rows = invariant.foot_innovation(self.belief, k, *seen[k]), invariant.foot_rows(self.belief, k)
            invariant.correct(self.belief, rows, innovation, np.square(scale * self.sight), np.inf, 0)
        return gyro, accelerometer, seen


def test_errors_are_as_large_as_the_covariance_says():
    runs, squares = 40, []
    for seed in range(runs):
        simulation = Simulation(seed)
        for tick in range(60):
            simulation.step(tick)
        error = error_between(simulation.truth, simulation.belief)
        squares.append(error @ np.linalg.solve(simulation.belief.covariance, error))
    low, high = chi2.ppf([0.005, 0.995], runs * SIZE)
    assert low < sum(squares) < high


def test_small_errors_are_those_of_least_squares_over_all_readings():
    """The last belief against one weighted least-squares problem over the errors at all times."""
    scale, ticks = 1e-5, 12
    simulation = Simulation(3, scale)
    nominal = copy_of(simulation.belief)  # moved by the readings alone: all is linear about it
    equations, right = [np.eye(SIZE, SIZE * (ticks + 1)) / (scale * simulation.start)[:, None]], [np.zeros(SIZE)]
    for tick in range(ticks):
        gyro, accelerometer, seen = simulation.step(tick)
        F = invariant.predict(nominal, gyro, accelerometer, GRAVITY, PERIOD)
        noise = F[:, 9:15] * scale * simulation.inertial
        noise[9:15] = 0.0
        Q = noise @ noise.T + np.diag(np.square(scale * simulation.walk)) + 1e-12 * scale**2 * np.eye(SIZE)
        whitened = np.linalg.inv(np.linalg.cholesky(Q))
        now, after = slice(SIZE * tick, SIZE * (tick + 1)), slice(SIZE * (tick + 1), SIZE * (tick + 2))
        rows = np.zeros((SIZE, SIZE * (ticks + 1)))
        rows[:, now], rows[:, after] = -whitened @ full(F), whitened
        equations.append(rows)
        right.append(np.zeros(SIZE))
        for k in range(FEET):
            rows = np.zeros((6, SIZE * (ticks + 1)))
            rows[:, after] = invariant.foot_rows(nominal, k) / (scale * simulation.sight)[:, None]
            equations.append(rows)
            right.append(invariant.foot_innovation(nominal, k, *seen[k]) / (scale * simulation.sight))
    solution = np.linalg.lstsq(np.vstack(equations), np.concatenate(right), rcond=None)[0][-SIZE:]
    found = error_between(simulation.belief, nominal)
    assert found == pytest.approx(solution, abs=1e-3 * np.abs(solution).max())
