"""The usual tick's short way and the change of variables, against each other and against the whole cascade."""

import numpy as np
import pytest

from solvers.cascade import Cascade
from solvers.direct import DirectSolver
from solvers.reduction import Reduction
from solvers.rows import Equality, Level

LEADING, TRAILING = 14, 10
SIZE = LEADING + TRAILING
NONE = np.zeros((0, SIZE)), np.zeros(0), np.zeros(0)


def hierarchy(rng, reach, room=1e3, posture_rows=LEADING):
    """Levels like a tick's: contacts, a coupled equation, bounds; small tasks, a posture, least forces.

    Args:
        rng: random numbers.
        reach: half width of the bounds on the trailing variables: the smaller, the more of them bite.
        room: the same on the leading variables.
        posture_rows: of the posture; five leave nothing to the other levels and are met where no bound bites.
    """
    centre = rng.normal(size=TRAILING)
    coupled = rng.normal(size=(4, SIZE))
    b = coupled[:, LEADING:] @ centre
    equalities = [Equality(rng.normal(size=(5, LEADING)), rng.normal(size=5)), Equality(coupled, 0.5 * b, 0.5)]
    box = np.eye(SIZE)
    width = np.append(np.full(LEADING, room), np.full(TRAILING, reach))
    hard = Level("hard", SIZE, equalities, box, -width, width)
    levels = [hard]
    for k in range(2):
        task = Equality(rng.normal(size=(2, LEADING)), rng.normal(size=2), 1.0 + k)
        levels.append(Level(f"task {k}", SIZE, [task], *NONE))
    wanted = rng.normal(size=posture_rows)
    posture = Equality(np.eye(LEADING)[:posture_rows], wanted, 2.0, 0, slice(0, posture_rows))
    levels.append(Level("posture", SIZE, [posture], *NONE))
    least = Equality(np.eye(TRAILING), 0.1 * rng.normal(size=TRAILING), 0.1, LEADING, slice(0, TRAILING))
    levels.append(Level("forces", SIZE, [least], *NONE))
    return levels


class Roundabout(Cascade):
    """A cascade that knows no short way."""

    def __init__(self):
        super().__init__()
        self._direct.solve = lambda levels: None


@pytest.mark.parametrize(
    ("reach", "room", "least"),
    [(1e3, 1e3, 40), (2.5, 1e3, 40), (1.5, 1e3, 40), (0.7, 1e3, 35), (1e3, 1.0, 35), (0.8, 1.0, 33)],
)
def test_the_short_way_leads_where_the_cascade_does(reach, room, least):
    """The smaller the reach, the more bounds cost the posture; those on the leading variables always do."""
    rng = np.random.default_rng(0)
    bitten = taken = 0
    for _ in range(40):
        levels = hierarchy(rng, reach, room)
        direct = DirectSolver(1e-7)
        x = direct.solve(levels)
        if x is None:
            continue
        taken += 1
        bitten += direct.active_sides.any()
        expected = Roundabout().solve(levels)
        np.testing.assert_allclose(x, expected.x, atol=1e-5 * np.abs(expected.x).max())
    assert taken >= least
    assert bool(bitten) == (min(reach, room) < 1e3)


def test_a_posture_that_could_be_met_gives_way_to_bounds():
    """Contacts and tasks leave as many variables as the posture has rows: without bounds it is met."""
    rng, taken = np.random.default_rng(5), 0
    for _ in range(40):
        levels = hierarchy(rng, 1.5, 2.5, posture_rows=LEADING - 9)
        direct = DirectSolver(1e-7)
        x = direct.solve(levels)
        if x is None or not direct.active_sides[:LEADING].any():
            continue
        taken += 1
        expected = Roundabout().solve(levels)
        np.testing.assert_allclose(x, expected.x, atol=1e-5 * np.abs(expected.x).max())
    assert taken >= 15


def test_what_was_held_is_let_go_when_it_pulls():
    levels = hierarchy(np.random.default_rng(1), 1e3)
    direct = DirectSolver(1e-7)
    free = direct.solve(levels)
    direct.warm_start(np.array([LEADING]), np.array([1.0]))
    np.testing.assert_allclose(direct.solve(levels), free, atol=1e-9)
    assert not direct.active_sides.any()


def test_hierarchies_of_another_kind_are_left_to_others():
    rng = np.random.default_rng(2)
    levels, direct = hierarchy(rng, 1e3), DirectSolver(1e-7)
    assert direct.solve(levels) is not None
    contradicting = [*levels]
    contradicting[2] = levels[1]
    own_bounds = [*levels]
    own_bounds[1] = Level("bounds", SIZE, [], np.eye(SIZE), -np.ones(SIZE), np.ones(SIZE))
    tight = [*levels]
    row, target = levels[1].equalities[0].A[:1], levels[1].b[:1]
    above_it = np.hstack([row, np.zeros((1, TRAILING))]), target + 1.0, target + 2.0
    tight[0] = Level("tight", SIZE, levels[0].equalities, *above_it)
    broken = [*levels]
    broken[1] = Level("broken", SIZE, [Equality(np.full((1, LEADING), np.nan), np.zeros(1))], *NONE)
    for other in (contradicting, own_bounds, tight, broken, levels[:-1], levels[:2]):
        assert direct.solve(other) is None


def test_the_change_of_variables_reaches_what_level_0_admits_and_nothing_else():
    rng = np.random.default_rng(3)
    levels = hierarchy(rng, 1e3)
    reduction = Reduction.of(levels[0], LEADING, 1e-7)
    assert reduction.T.shape == (SIZE, SIZE - 9) and np.linalg.matrix_rank(reduction.T) == SIZE - 9
    z = rng.normal(size=SIZE - 9)
    x = reduction.full_solution(z)
    np.testing.assert_allclose(levels[0].A @ x, levels[0].b, atol=1e-10)
    for mine, level in zip(reduction.reduced_levels(levels)[1:], levels[1:], strict=True):
        np.testing.assert_allclose(mine.violation(z), level.violation(x), atol=1e-10)


def test_equalities_that_contradict_each_other_have_no_change_of_variables():
    J = np.ones((2, LEADING))
    hard = Level("hard", SIZE, [Equality(J, np.array([0.0, 1.0]))], *NONE)
    assert Reduction.of(hard, LEADING, 1e-7) is None
    starved = Level("hard", SIZE, [Equality(np.eye(SIZE)[:1], np.zeros(1))], *NONE)
    assert Reduction.of(starved, 0, 1e-7) is not None
    assert Reduction.of(starved, 1, 1e-7) is None


@pytest.mark.parametrize("solver", [Cascade, Roundabout])
@pytest.mark.filterwarnings("error")
def test_a_bound_that_has_gone_holds_nothing(solver):
    levels = hierarchy(np.random.default_rng(1), 1.5)
    cascade = solver()
    bitten = cascade.solve(levels).x
    hard = levels[0]
    hard.lower[LEADING:], hard.upper[LEADING:] = -np.inf, np.inf
    free = cascade.solve(levels).x
    assert np.isfinite(free).all() and np.abs(free - bitten).max() > 1e-3
    np.testing.assert_allclose(free, solver().solve(levels).x, atol=1e-8)


def test_levels_of_one_kind_are_worked_out_once():
    """What is remembered of levels that carry a kind goes with any numbers in them."""
    rng, taken = np.random.default_rng(4), 0
    kept, direct = hierarchy(rng, 1.5), DirectSolver(1e-7)
    kept[0].structure_key = object()
    for _ in range(20):
        fresh = hierarchy(rng, 1.5)
        for mine, other in zip(kept, fresh, strict=True):
            for e, o in zip(mine.equalities, other.equalities, strict=True):
                e.A, e.b = o.A, o.b
            mine.clear_cache()
        if (x := direct.solve(kept)) is not None:
            np.testing.assert_allclose(x, Roundabout().solve(fresh).x, atol=1e-5 * np.abs(x).max())
            taken += 1
    assert taken > 15
    kept[2] = kept[1]  # rows that depend on others
    kept[0].structure_key = object()
    assert direct.solve(kept) is None
