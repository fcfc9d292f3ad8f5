"""What Kim & Oh say of task corrections, where it is true, against independent solvers; and where it is not."""

import numpy as np
import pytest
import qpsolvers
from scipy.optimize import linprog

from solvers import Cascade, Level, Rows, Status, TaskCorrection
from solvers.task_correction import PrioritizedTasks, Task

TOLERANCE = 1e-7


def random_tasks(rng, n, rows, deficient=False):
    """Tasks of so many rows each; a deficient one repeats rows of the tasks above and sums its own."""
    tasks = []
    for k, m in enumerate(rows):
        J = rng.standard_normal((m, n))
        if deficient and k:
            above = tasks[-1].J
            J[0] = rng.standard_normal(len(above)) @ above
            J[-1] = J[:-1].sum(axis=0)
        tasks.append(Task(J, 3.0 * rng.standard_normal(m)))
    return tasks


def sizes(rng, square=False):
    """Number of variables, and rows of two to five tasks, Kim (18)."""
    rows = rng.integers(1, 5, int(rng.integers(2, 6)))
    return int(rows.sum() + (0 if square else rng.integers(0, 4))), rows.tolist()


def kim_5(tasks):
    """Kim (4)-(7) as printed, with pseudo-inverses of full size."""
    n = tasks[0].J.shape[1]
    x, N = np.zeros(n), np.eye(n)
    for task in tasks:
        left = task.J @ N
        inverse = np.linalg.pinv(left, rcond=min(1.0, 1e-9 * np.linalg.norm(task.J) / np.linalg.norm(left)))
        x, N = x + inverse @ (task.h - task.J @ x), N - inverse @ task.J @ N
    return x


def corrected(tasks, changes):
    return [Task(task.J, task.h + change) for task, change in zip(tasks, changes, strict=True)]


def levels_of(tasks, lower, upper):
    n = len(lower)
    hard = Level.stack("bounds", [Rows("bounds", "1", np.eye(n), lower, upper, gives_way=1)], n)
    return [hard, *(Level.stack(f"task {k}", [Rows("t", "1", t.J, t.h, t.h)], n) for k, t in enumerate(tasks))]


def qps(solution):
    return sum(level.needed_qp for level in solution.levels)


@pytest.mark.parametrize("deficient", [False, True])
def test_algorithm_1_gives_what_corrections_do_to_the_solution(deficient):
    rng = np.random.default_rng(0)
    for _ in range(30):
        n, rows = sizes(rng)
        tasks = random_tasks(rng, n, [m + deficient for m in rows], deficient)
        priorities = PrioritizedTasks(tasks, 0.0, 1e-9)
        np.testing.assert_allclose(priorities.x, kim_5(tasks), atol=1e-8)
        changes = [rng.standard_normal(len(task.h)) for task in tasks]
        moved = kim_5(corrected(tasks, changes)) - kim_5(tasks)
        np.testing.assert_allclose(np.hstack(priorities.correction_gains()) @ np.concatenate(changes), moved, atol=1e-8)


def test_without_singularities_corrections_are_the_task_errors_and_g_the_inverse_of_the_stacked_tasks():
    rng = np.random.default_rng(1)
    for _ in range(30):
        n, rows = sizes(rng)
        tasks = random_tasks(rng, n, rows)
        priorities = PrioritizedTasks(tasks, 0.0, 1e-9)
        gains = priorities.correction_gains()
        G, J = np.hstack(gains), np.vstack([task.J for task in tasks])
        assert np.linalg.matrix_rank(G) == sum(rows)  # Remark 1, its first half
        np.testing.assert_allclose(G, np.linalg.pinv(J), atol=1e-8 * np.linalg.cond(J))
        change = rng.standard_normal(sum(rows))
        error = J @ (priorities.x + G @ change) - np.concatenate([task.h for task in tasks])
        np.testing.assert_allclose(error, change, atol=1e-7)


def test_kim_19_as_printed_misses_the_corrected_tasks():
    rng = np.random.default_rng(2)
    tasks = random_tasks(rng, 6, [2, 2, 2])  # of equal size: otherwise it cannot even be computed
    x, N, above = np.zeros(6), np.eye(6), None
    for task in tasks:
        inverse = np.linalg.pinv(task.J @ N)
        x = x + inverse @ (task.h - (task.J if above is None else above) @ x)
        N, above = N - inverse @ task.J @ N, task.J
    assert np.abs(tasks[1].J @ x - tasks[1].h).max() > 0.1
    for task in tasks:
        np.testing.assert_allclose(task.J @ kim_5(tasks), task.h, atol=1e-9)


@pytest.mark.parametrize("damping", [1e-3, 0.1, 1.0])
def test_damping_restores_no_rank(damping):
    """Against Remark 1, its second half: a direction in which a task cannot move it cannot be corrected either."""
    rng = np.random.default_rng(3)
    J = rng.standard_normal((2, 5))
    tasks = [Task(J, np.zeros(2)), Task(np.vstack([rng.standard_normal((1, 5)), J[0] - J[1]]), np.zeros(2))]
    G = np.hstack(PrioritizedTasks(tasks, damping, 1e-9).correction_gains())
    assert np.linalg.matrix_rank(G) == 3 < G.shape[1]
    damped = J.T @ np.linalg.inv(J @ J.T + damping**2 * np.eye(2))
    np.testing.assert_allclose(G[:, :2][:, :], damped - _second(tasks, damping) @ tasks[1].J @ damped, atol=1e-12)
    singular = np.outer([1.0, 2.0], [1.0, 0.0, -1.0])
    damped = singular.T @ np.linalg.inv(singular @ singular.T + damping**2 * np.eye(2))
    assert np.linalg.matrix_rank(damped) == np.linalg.matrix_rank(singular) == 1


def _second(tasks, damping):
    """Damped inverse of the second task's rows in what the first leaves, of its directions that are not rounding."""
    first, second = (task.J for task in tasks)
    B = second @ (np.eye(first.shape[1]) - np.linalg.pinv(first) @ first)
    return B.T @ np.linalg.inv(B @ B.T + damping**2 * np.eye(len(B)))


def test_damped_inverses_keep_the_answer_small_and_priorities_as_they_are():
    tasks = [Task(np.array([[1.0, 1.0, 0.0]]), np.ones(1)), Task(np.array([[1.0, 1.0 + 1e-4, 0.0]]), np.zeros(1))]
    bound = np.full(3, 1e9)
    sharp = TaskCorrection().solve(levels_of(tasks, -bound, bound))
    damped = TaskCorrection(damping=0.01).solve(levels_of(tasks, -bound, bound))
    assert np.abs(sharp.x).max() > 1e3 and np.abs(damped.x).max() < 2.0
    # The lower task, of whatever damping, moves nothing of the higher one.
    alone = TaskCorrection(damping=0.01).solve(levels_of(tasks[:1], -bound, bound))
    np.testing.assert_allclose(tasks[0].J @ damped.x, tasks[0].J @ alone.x, atol=1e-12)


def algorithm_2(tasks, lower, upper):
    """The oracle: Kim (23) with a linear program for feasibility and an interior-point method for the QP."""
    x = kim_5(tasks)
    if (x >= lower - TOLERANCE).all() and (x <= upper + TOLERANCE).all():
        return x, len(tasks)
    for k in reversed(range(len(tasks))):
        rest = tasks[k:]
        # g_k^a by superposition: what unit corrections do.
        columns = []
        for i in range(len(rest)):
            for unit in np.eye(len(rest[i].h)):
                changes = [np.zeros(len(task.h)) for task in tasks]
                changes[k + i] = unit
                columns.append(kim_5(corrected(tasks, changes)) - x)
        G = np.column_stack(columns)
        rows, bounds = np.vstack([G, -G]), np.concatenate([upper - x, x - lower])
        if linprog(np.zeros(G.shape[1]), rows, bounds, bounds=(None, None)).status == 0:
            problem = qpsolvers.Problem(np.eye(G.shape[1]), np.zeros(G.shape[1]), rows, bounds)
            return x + G @ qpsolvers.solve_problem(problem, solver="quadprog").x, k
    return None, 0


def test_algorithm_2_finds_the_least_correction_of_the_lowest_tasks_that_suffice():
    rng = np.random.default_rng(4)
    stages = []
    solver = TaskCorrection()
    for _ in range(150):
        n, rows = sizes(rng)
        tasks = random_tasks(rng, n, rows)
        reach = np.abs(kim_5(tasks)).max()
        lower, upper = (sign * reach * rng.uniform(0.4, 2.0, n) for sign in (-1.0, 1.0))
        expected, first = algorithm_2(tasks, lower, upper)
        if expected is None:
            continue
        solution = solver.solve(levels_of(tasks, lower, upper))
        stages.append(len(tasks) - first)
        scale = 1.0 + reach
        np.testing.assert_allclose(solution.x, expected, atol=1e-6 * scale)
        assert (solution.x <= upper + 1e-6).all() and (solution.x >= lower - 1e-6).all()
        for task in tasks[:first]:
            np.testing.assert_allclose(task.J @ solution.x, task.h, atol=1e-6 * scale)
        assert qps(solution) == (first < len(tasks))  # one at most, none where no bound is exceeded
        assert solution.status == Status.SOLVED
    assert min(stages.count(k) for k in range(3)) >= 10, "too few corrections of none, one and two tasks"


@pytest.mark.parametrize("deficient", [False, True])
def test_equals_the_cascade_where_no_bound_is_active(deficient):
    rng = np.random.default_rng(5)
    mine, cascade = TaskCorrection(), Cascade()
    for _ in range(50):
        n, rows = sizes(rng)
        tasks = random_tasks(rng, n, [m + deficient for m in rows], deficient)
        wide = np.full(n, 1e6)
        levels = levels_of(tasks, -wide, wide)
        solution, other = mine.solve(levels), cascade.solve(levels)
        assert not qps(solution)
        for level in levels[1:]:  # what the tasks leave open is each solver's own
            np.testing.assert_allclose(level.violation(solution.x), level.violation(other.x), atol=1e-6)
        np.testing.assert_allclose(solution.x, kim_5(tasks), atol=1e-6)


def test_equals_the_cascade_where_the_last_task_alone_is_corrected_and_nothing_is_left_open():
    rng = np.random.default_rng(6)
    mine, cascade, compared = TaskCorrection(), Cascade(), 0
    for _ in range(150):
        n, rows = sizes(rng, square=True)
        tasks = random_tasks(rng, n, rows)
        reach = np.abs(kim_5(tasks)).max()
        levels = levels_of(tasks, *(sign * reach * rng.uniform(0.5, 1.5, n) for sign in (-1.0, 1.0)))
        solution = mine.solve(levels)
        if solution.levels[-1].needed_qp:
            np.testing.assert_allclose(solution.x, cascade.solve(levels).x, atol=1e-5 * (1.0 + reach))
            compared += 1
    assert compared > 20


def test_corrects_a_task_that_redundancy_could_have_kept():
    """Not in the paper: Kim (20) moves within the least-norm solution; what the tasks leave open stays unused."""
    task = Task(np.array([[1.0, 1.0]]), np.array([2.0]))
    levels = levels_of([task], np.full(2, -9.0), np.array([0.5, 9.0]))
    assert TaskCorrection().solve(levels).levels[1].error == pytest.approx(1.0)
    assert Cascade().solve(levels).levels[1].error == pytest.approx(0.0, abs=1e-6)
    # A last task that takes what is left is corrected first.
    levels.append(Level.stack("rest", [Rows("rest", "1", np.eye(2), np.zeros(2), np.zeros(2))], 2))
    assert TaskCorrection().solve(levels).levels[1].error == pytest.approx(0.0, abs=1e-6)


def test_of_two_corrected_tasks_the_higher_gives_up_more_than_the_cascade_has_it_give_up():
    """Not in the paper: Kim (23) has one norm for all tasks that are corrected, whatever their priority."""
    tasks = [Task(np.array([[1.0, 1.0]]), np.array([2.0])), Task(np.array([[0.0, 1.0]]), np.array([1.0]))]
    levels = levels_of(tasks, np.full(2, -9.0), np.array([0.4, 1.6 - 1e-5]))
    mine, cascade = TaskCorrection().solve(levels), Cascade().solve(levels)
    errors = [[level.error for level in solution.levels[1:]] for solution in (mine, cascade)]
    assert mine.levels[1].needed_qp  # the last one alone would not have been enough
    assert errors[0][0] > errors[1][0] + 0.2
    assert np.hypot(*errors[0]) < np.hypot(*errors[1])
    # As soon as the last one alone is enough, the higher one gives up nothing: a jump.
    barely = levels_of(tasks, np.full(2, -9.0), np.array([0.4, 1.6 + 1e-5]))
    assert TaskCorrection().solve(barely).levels[1].error == pytest.approx(0.0, abs=1e-5)


def test_without_a_sufficient_correction_the_cascade_answers():
    task = Task(np.array([[1.0, 0.0]]), np.ones(1))
    lower, upper = np.array([-1.0, 0.5]), np.array([1.0, 1.0])  # nothing moves the second variable
    levels = levels_of([task], lower, upper)
    solution, other = TaskCorrection().solve(levels), Cascade().solve(levels)
    np.testing.assert_array_equal(solution.x, other.x)
    assert solution.status == other.status == Status.SOLVED
    contrary = Rows("contrary", "1", np.eye(2), np.full(2, -1.0), np.full(2, 0.4))
    levels[0] = Level.stack("bounds", [Rows("bounds", "1", np.eye(2), lower, upper, gives_way=1), contrary], 2)
    relaxed = TaskCorrection().solve(levels)
    assert relaxed.status == Status.RELAXED and list(relaxed.relaxed) == ["bounds"]


def test_inequalities_of_lower_levels_are_the_cascade_s():
    levels = levels_of([Task(np.eye(2), np.array([3.0, 1.0]))], np.full(2, -2.0), np.full(2, 2.0))
    floor = Rows("floor", "1", np.array([[0.0, 1.0]]), np.array([1.5]), np.array([np.inf]))
    levels.insert(1, Level.stack("floor", [floor], 2))
    np.testing.assert_allclose(TaskCorrection().solve(levels).x, [2.0, 1.5], atol=1e-6)
