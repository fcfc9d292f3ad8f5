"""Rows that contradict each other: the planted ones are named, no more of them than it takes, and what would help."""

import numpy as np
import pytest

from solvers import Cascade, Level, Rows
from solvers.conflict import ConflictError, find_conflict, solve_or_explain


def rows(name, A, lower, upper, gives_way=0, weight=1.0):
    A = np.atleast_2d(A)
    return Rows(name, "m/s²", A, np.full(len(A), lower), np.full(len(A), upper), weight, gives_way)


def test_nothing_to_explain_where_everything_holds():
    levels = [Level.stack("hard", [rows("box", np.eye(3), -1.0, 1.0)], 3)]
    assert find_conflict(levels) is None
    assert solve_or_explain(Cascade(), levels).x.shape == (3,)


def test_the_row_that_would_give_way_is_told_with_what_would_help():
    box = rows("box", np.eye(3), -1.0, 1.0, gives_way=1, weight=0.5)
    levels = [
        Level.stack("hard", [box, rows("pull", [1.0, 1.0, 0.0], 2.5, 2.5), rows("far", [0, 0, 1.0], 0.5, 9.0)], 3)
    ]
    conflict = find_conflict(levels)
    assert conflict.owners == {"box", "pull"}
    changed = [row for row in conflict.rows if row.bound_change]
    assert sum(row.bound_change for row in changed) == pytest.approx(0.5, abs=1e-6)
    assert all(row.owner == "box" and row.side == "upper" for row in changed)
    assert str(conflict).startswith("box: row") and str(conflict).endswith("pull")
    with pytest.raises(ConflictError, match=r"'hard' has no solution: box.*pull"):
        solve_or_explain(Cascade(), levels)


def test_planted_rows_are_found_among_many_and_none_of_them_is_spare():
    rng = np.random.default_rng(0)
    for _ in range(30):
        n = 12
        inside = rng.normal(size=n)
        crowd = [
            rows(f"crowd {k}", A, value - 1.0, value + 1.0)
            for k, A in enumerate(rng.normal(size=(15, n)))
            for value in [A @ inside]
        ]
        directions = rng.normal(size=(3, n))
        against = -directions.sum(axis=0)  # the four directions add up to nothing, what is asked of them does not
        planted = [rows(f"planted {k}", d, d @ inside, np.inf) for k, d in enumerate((*directions, against))]
        planted[0].lower = planted[0].lower + 0.3
        mixed = [*crowd, *planted]
        rng.shuffle(mixed)
        conflict = find_conflict([Level.stack("hard", mixed, n)])
        assert conflict.owners == {f"planted {k}" for k in range(4)}
        left = [row for row in mixed if row.name != "planted 2"]
        assert find_conflict([Level.stack("hard", left, n)]) is None


def test_a_lower_level_is_told_what_stands_in_its_way():
    hard = Level.stack("hard", [rows("limit", np.eye(2), -1.0, 1.0)], 2)
    first = Level.stack("first", [rows("first", [1.0, -1.0], 0.0, 0.0)], 2)
    second = Level.stack("second", [rows("second", [1.0, 1.0], 3.0, 3.0)], 2)
    solution = Cascade().solve([hard, first, second])
    np.testing.assert_allclose(solution.x, 1.0, atol=1e-6)
    conflict = find_conflict([hard, first, second], 2, solution.x)
    (changed,) = (row for row in conflict.rows if row.bound_change)
    assert changed.owner == "second" and changed.bound_change == pytest.approx(-1.0, abs=1e-5)
    assert "limit" in conflict.owners
    assert find_conflict([hard, first], 1, solution.x) is None
