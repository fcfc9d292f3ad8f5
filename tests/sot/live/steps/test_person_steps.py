"""Steps of a person who walks by a formula: found as they come, and where they end."""

from collections import deque

import numpy as np
import pytest

from sot.live.person import Moment
from sot.live.steps.foot_sense import percentile
from sot.live.steps.person_steps import PersonSteps
from sot.smooth import minimum_jerk

LEG, ANKLE, RATE = 0.8, 0.08, 50.0
STRIDE, SWING, STANCE = 0.6, 0.5, 0.7


def moment(places, heights, heading=0.0):
    """A person whose feet, (x, y) each, are at heights."""
    points = {}
    ahead = 0.15 * np.array([np.cos(heading), np.sin(heading), 0.0])
    for side, (x, y), z in zip(("left", "right"), places, heights, strict=True):
        points[f"{side}_ankle"] = np.array([x, y, ANKLE + z])
        points[f"{side}_toe"] = points[f"{side}_ankle"] + ahead - [0.0, 0.0, 0.06]
    points["waist"] = np.append(np.mean(places, axis=0), 0.95)
    c, s = np.cos(heading), np.sin(heading)
    return Moment(points, {"pelvis": np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])})


def foot_x(t, first):
    """Way and height of a foot whose first swing begins at a time."""
    period = SWING + STANCE
    count, within = max(0, int((t - first) // period)), (t - first) % period if t >= first else period
    if t < first:
        return 0.0, 0.0
    share = min(within / SWING, 1.0)
    return STRIDE * (count + float(minimum_jerk(np.array(share)))), 0.1 * np.sin(np.pi * share)


def walk(steps, until, start=0.0):
    found = []
    for k in range(round(start * RATE), round(until * RATE)):
        t = k / RATE
        (left, up), (right, high) = foot_x(t, 1.0), foot_x(t, 1.0 + 0.5 * (SWING + STANCE))
        steps(moment([(left, 0.1), (right, -0.1)], [up, high]), t)
        found += [(t, steps.asked.popleft()) for _ in range(len(steps.asked))]
    return found


def test_each_step_is_told_once_soon_after_its_lift_and_lands_where_the_foot_does():
    found = walk(PersonSteps(LEG), 4.0)
    assert [step.foot for _, step in found] == 2 * ["left_foot", "right_foot"] + ["left_foot"]
    for told, step in found[:4]:
        assert told - step.lift < 0.2
        assert step.has_landed and step.land == pytest.approx(step.lift + SWING, abs=0.15)
        assert step.place.x - step.start.x == pytest.approx(STRIDE, abs=0.02)
        assert step.height > 0.08


def test_half_way_through_a_step_its_end_is_known_to_a_fifth_of_its_length():
    steps = PersonSteps(LEG)
    walk(steps, 1.0 + 0.5 * (SWING + STANCE))
    ((_, step),) = walk(steps, 1.0 + 0.5 * (SWING + STANCE) + 0.65 * SWING, start=1.0 + 0.5 * (SWING + STANCE))
    assert not step.has_landed
    assert step.place.x == pytest.approx(STRIDE, abs=0.2 * STRIDE)


def test_a_foot_that_trembles_or_is_hardly_lifted_makes_no_step():
    steps, random = PersonSteps(LEG), np.random.default_rng(1)
    feet = np.array([(0.0, 0.1), (0.0, -0.1)])
    for k in range(150):
        lift = 0.03 * max(0.0, np.sin(0.1 * k))
        steps(moment(feet + random.normal(0.0, 0.001, (2, 2)), [lift, 0.0]), k / RATE)
    assert steps.asked == deque()


def test_a_foot_that_slides_and_stays_elsewhere_has_made_a_step():
    steps = PersonSteps(LEG)
    for k in range(200):
        x = 0.2 * float(minimum_jerk(np.array((k - 50) / 100.0)))
        steps(moment([(x, 0.1), (0.0, -0.1)], [0.0, 0.0]), k / RATE)
    places = [step.place.x for step in steps.asked]
    assert len(places) >= 1 and all(step.has_landed for step in steps.asked)
    assert places[-1] == pytest.approx(0.2, abs=0.1)


def test_a_turn_on_the_spot_is_told_with_its_angle():
    steps = PersonSteps(LEG)
    for k in range(150):
        share = float(minimum_jerk(np.array((k - 50) / 25.0)))
        up = 0.1 * np.sin(np.pi * min(max((k - 50) / 25.0, 0.0), 1.0))
        left = moment([(0.0, 0.1), (0.0, -0.1)], [up, 0.0], heading=0.8 * share)
        right = moment([(0.0, 0.1), (0.0, -0.1)], [up, 0.0])
        points = left.points | {name: at for name, at in right.points.items() if name.startswith("right")}
        steps(Moment(points, right.frames), k / RATE)
    (step,) = steps.asked
    assert step.foot == "left_foot" and step.place.heading == pytest.approx(0.8, abs=0.05)


@pytest.mark.parametrize("count", [1, 2, 5, 10, 40])
def test_percentiles_are_numpys(count):
    values = np.random.default_rng(count).normal(size=count).tolist()
    for percent in (0.0, 10.0, 50.0, 100.0):
        assert percentile(deque(values), percent) == pytest.approx(np.percentile(values, percent), abs=1e-12)
