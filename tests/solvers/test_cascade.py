"""The cascade against an independent solver, and what it does when there is no solution."""

from pathlib import Path

import numpy as np
import pytest

from solvers import Cascade, Level, Rows, Status, Weighted
from solvers.proxqp import QP, PersistentQPs
from tests.solvers.hierarchies import lexicographic_optimum, random_hierarchy

KINDS = ("feasible", "conflicting", "deficient", "active")
SOFT = ("balance", "waist", "posture", "forces")


@pytest.mark.parametrize("kind", KINDS)
def test_every_level_reaches_the_lexicographic_optimum(kind):
    rng = np.random.default_rng(KINDS.index(kind))
    bitten = 0
    solver = Cascade()
    for _ in range(50):  # 200 hierarchies in all
        levels = random_hierarchy(rng, kind)
        solution = solver.solve(levels)
        assert solution.status in (Status.SOLVED, Status.SECOND_SOLVER)
        assert np.abs(levels[0].violation(solution.x)).max() < 1e-6
        for level, oracle in zip(levels[1:], lexicographic_optimum(levels), strict=True):
            mine = level.violation(solution.x)
            scale = 1.0 + np.abs(level.b).max(initial=0.0)
            assert np.linalg.norm(mine) == pytest.approx(np.linalg.norm(oracle), abs=1e-6 * scale), level.name
        bitten += any(level.needed_qp for level in solution.levels)
    assert bitten >= 25, "the hierarchies are too easy to test the inequalities"


def recorded(number: int) -> list[Level]:
    """A tick's hierarchy in the variables that level 0's equalities leave; its last level has no room to move in."""
    with np.load(Path(__file__).with_name("thin.npz")) as file:
        C, lower, upper = (file[f"{number}_{part}"] for part in ("C", "lower", "upper"))
        n = C.shape[1]
        soft = [(name, file[f"{number}_{name}_A"], file[f"{number}_{name}_b"]) for name in SOFT]
    levels = [Level.stack("hard", [Rows("limits", "1", C, lower, upper)], n)]
    return levels + [Level.stack(name, [Rows(name, "1", A, b, b)], n) for name, A, b in soft]


@pytest.mark.parametrize("number", range(2))
def test_what_is_left_may_have_no_width(number):
    levels = recorded(number)
    solution = Cascade().solve(levels)
    assert solution.status <= Status.SECOND_SOLVER  # rounding decides; without more room none has an answer
    assert np.abs(levels[0].violation(solution.x)).max() < 1e-6
    optima = [np.linalg.norm(violation) for violation in lexicographic_optimum(levels)]
    assert [result.error for result in solution.levels[1:-1]] == pytest.approx(optima[:-1], abs=1e-6)
    # How far the last level comes in a gap no wider than rounding is a matter of rounding.
    assert solution.levels[-1].error == pytest.approx(optima[-1], rel=0.02)


def test_a_bound_that_kept_a_level_from_doing_better_is_left_as_soon_as_it_does_not():
    # At the second tick the first level can be met with the bound held that it pushed against before, and does not push
    # any more: but held it would keep the second level from doing better.
    cascade = Cascade()
    hard, wish = Level.stack("hard", [bounds("box", -1.0, 1.0, 1)], 2), np.full(2, 0.2)
    for row, target, best in (([1.0, 0.0], 3.0, [1.0, 0.2]), ([1.0, 1.0], 1.5, [0.75, 0.75])):
        first = Level.stack("first", [Rows("row", "1", np.array([row]), *2 * [np.full(1, target)])], 2)
        second = Level.stack("second", [Rows("wish", "1", np.eye(2), wish, wish)], 2)
        assert cascade.solve([hard, first, second]).x == pytest.approx(best, abs=1e-6)


def test_near_degenerate_levels_stay_bounded_and_feasible_above():
    rng = np.random.default_rng(7)
    for _ in range(100):
        levels = random_hierarchy(rng, "conflicting")
        twin = levels[1]
        nudged = twin.A + 10.0 ** rng.uniform(-12, -4) * rng.standard_normal(twin.A.shape)
        n = twin.A.shape[1]
        target = twin.b + rng.standard_normal(len(twin.b))
        levels.insert(2, Level.stack("nearly the level above", [Rows("twin", "1", nudged, target, target)], n))
        solution = Cascade().solve(levels)
        assert np.abs(levels[0].violation(solution.x)).max() < 1e-6
        assert np.abs(solution.x).max() < 100.0
        above = lexicographic_optimum(levels[:2])[0]
        assert np.linalg.norm(twin.violation(solution.x)) == pytest.approx(np.linalg.norm(above), abs=1e-5)


def test_damping_bounds_the_answer_near_a_singularity():
    A = np.array([[1.0, 0.0], [1.0, 1e-5]])
    levels = [
        Level.stack("none", [], 2),
        Level.stack("singular", [Rows("r", "1", A, *2 * [np.array([0.0, 1.0])])], 2),
    ]
    assert np.abs(Cascade().solve(levels).x).max() == pytest.approx(1e5, rel=1e-3)
    assert np.abs(Cascade(damping=0.01).solve(levels).x).max() < 1.0


def bounds(name: str, low: float, high: float, gives_way: int) -> Rows:
    return Rows(name, "1", np.eye(2), np.full(2, low), np.full(2, high), gives_way=gives_way)


def test_level_0_gives_way_in_its_order_and_says_so():
    # Each of the three contradicts the next: the first to give way is the only one that has to.
    hard = [bounds("joints", 2.0, 3.0, 1), bounds("torques", -1.0, 1.5, 2), bounds("friction", -1.0, 1.0, 3)]
    target = np.array([9.0, -9.0])
    soft = Level.stack("task", [Rows("task", "1", np.eye(2), target, target)], 2)
    solution = Cascade().solve([Level.stack("hard", hard, 2), soft])
    assert solution.status == Status.RELAXED
    assert solution.relaxed == {"joints": pytest.approx(1.0, abs=1e-6)}
    assert solution.x == pytest.approx(np.ones(2), abs=1e-6)
    assert [level.name for level in solution.levels] == ["hard", "task"]


@pytest.mark.parametrize(
    ("task", "most", "kept"),
    [([1.0, 0.5], 0.7, True), ([1.0, 0.0], 0.7, False), ([1.0, 0.5], -2.0, False)],
    ids=["posture pays", "a task would pay", "infeasible"],
)
def test_optional_rows_hold_where_no_level_above_the_last_two_pays(task, most, kept):
    def rows(name, A, target):
        return Rows(name, "1", np.array(A), np.array(target), np.array(target))

    box, least = bounds("box", -1.0, 1.0, 1), np.full(2, -9.0)
    soft = [
        Level.stack("task", [rows("task", [task], [0.9])], 2),
        Level.stack("posture", [rows("posture", np.eye(2), [0.8, 0.2])], 2),
        Level.stack("last", [rows("last", np.eye(2), [0.0, 0.0])], 2),
    ]
    rates = Rows("rates", "1", np.eye(2), least, np.array([most, 9.0]), optional=True)
    hard = Level.stack("hard", [box, rates] if kept else [box], 2)
    expected = [float(np.linalg.norm(violation)) for violation in lexicographic_optimum([hard, *soft])]
    solution = Cascade().solve([Level.stack("hard", [box, rates], 2), *soft])
    assert solution.status == Status.SOLVED and solution.relaxed == {}
    assert [np.linalg.norm(level.violation(solution.x)) for level in soft] == pytest.approx(expected, abs=1e-6)
    assert (solution.x[0] <= most + 1e-6) == kept


class GivesUpOnce(Cascade):
    """A cascade that knows no short way, and whose QP solvers do not find the first answer."""

    gave_up = False

    def __init__(self):
        super().__init__()
        self._direct.solve = lambda levels: None

    def _solve_levels(self, levels):
        answer = super()._solve_levels(levels)
        if not self.gave_up:
            self.gave_up, answer.levels[0].status = True, Status.FAILED
        return answer


def test_level_0_that_had_a_solution_after_all_is_not_called_infeasible():
    hard = Level.stack("hard", [bounds("joints", -2.0, 3.0, 1), bounds("torques", -1.0, 1.5, 2)], 2)
    target = np.array([9.0, -9.0])
    solution = GivesUpOnce().solve([hard, Level.stack("task", [Rows("task", "1", np.eye(2), target, target)], 2)])
    assert solution.status == Status.SECOND_SOLVER and solution.relaxed == {}
    assert "found in parts" in solution.levels[0].reason
    assert solution.x == pytest.approx([1.5, -1.0], abs=1e-6)


@pytest.mark.parametrize("below", [[], [Level.stack("none", [], 2)]])
def test_rows_that_never_give_way_fail_without_an_answer(below):
    hard = [bounds("a", 2.0, 3.0, 0), bounds("b", -1.0, 1.0, 0)]
    assert Cascade().solve([Level.stack("hard", hard, 2), *below]).status == Status.FAILED


def test_level_0_alone_gives_a_point_that_satisfies_it():
    solution = Cascade().solve([Level.stack("hard", [bounds("a", 2.0, 3.0, 0)], 2)])
    assert solution.status == Status.SOLVED and len(solution.levels) == 1
    assert (solution.x >= 2.0 - 1e-6).all()


def test_contradicting_equalities_of_level_0_fail():
    rows = [
        Rows("a", "1", np.eye(2), np.zeros(2), np.zeros(2)),
        Rows("b", "1", np.eye(2), np.ones(2), np.ones(2)),
    ]
    assert Cascade().solve([Level.stack("hard", rows, 2)]).status == Status.FAILED


def test_a_problem_that_proxqp_gives_up_goes_to_the_second_solver():
    rng = np.random.default_rng(3)
    C = rng.standard_normal((20, 6))
    b, width = 50.0 * rng.standard_normal(6), rng.uniform(0.1, 1.0, 20)
    problem = QP(np.eye(6), b, C, -width, width)
    capped, free = PersistentQPs(max_iterations=1).solve("k", problem), PersistentQPs().solve("k", problem)
    assert capped.status == Status.SECOND_SOLVER and free.status == Status.SOLVED
    assert capped.reason == "ProxQP gave up after 1 iteration, quadprog solved it" and not free.reason
    assert capped.y == pytest.approx(free.y, abs=1e-6)
    assert capped.multipliers == pytest.approx(free.multipliers, abs=1e-4)


def test_an_accepted_answer_is_optimal_not_only_feasible():
    # ProxQP's residuals alone let answers pass whose multipliers push on rows that are not tight.
    rng = np.random.default_rng(1)
    for _ in range(50):
        n, m = 12, 30
        E, C = rng.standard_normal((3, n)), rng.standard_normal((m, n))
        width = rng.uniform(0.05, 1.0, m)
        qp = PersistentQPs().solve("k", QP(E, 5.0 * rng.standard_normal(3), C, -width, width))
        gap = np.minimum(width - C @ qp.y, width + C @ qp.y)
        assert np.abs(gap * qp.multipliers).max() < 1e-6


@pytest.mark.parametrize("ratio", [2.0, 100.0])
def test_weighted_shares_a_conflict_in_the_ratio_of_the_weights(ratio):
    one = np.eye(1)
    levels = [Level.stack("none", [], 1)]
    levels += [Level.stack(f"{t}", [Rows("r", "1", one, np.full(1, t), np.full(1, t))], 1) for t in (0.0, 1.0)]
    solution = Weighted(ratio=ratio).solve(levels)
    assert solution.x[0] == pytest.approx(1.0 / (1.0 + ratio))
    assert [level.name for level in solution.levels] == ["none", "0.0", "1.0"]
    assert [level.error for level in solution.levels] == pytest.approx([0.0, 1 / (1 + ratio), ratio / (1 + ratio)])


def test_weighted_respects_level_0_as_the_cascade_does():
    rng = np.random.default_rng(5)
    for _ in range(20):
        levels = random_hierarchy(rng, "active")
        solution = Weighted().solve(levels)
        assert np.abs(levels[0].violation(solution.x)).max() < 1e-6


@pytest.mark.parametrize(
    ("A", "lower", "upper", "word"),
    [
        (np.zeros((1, 3)), [0.0], [0.0], "n is 2"),
        (np.array([[np.nan, 0.0]]), [0.0], [0.0], "not a number"),
        (np.zeros((1, 2)), [1.0], [0.0], "above"),
    ],
)
def test_bad_rows_are_refused_by_name(A, lower, upper, word):
    with pytest.raises(ValueError, match=f"posture: .*{word}"):
        Level.stack("level", [Rows("posture", "rad/s²", A, np.array(lower), np.array(upper))], 2)
