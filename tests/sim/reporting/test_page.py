"""A run's page holds what was measured, peaks included, needs nothing from elsewhere, and takes any name."""

import json
import re

import numpy as np
import pytest

from sim.log import RunInfo
from sim.reporting import page, page_plots
from sim.reporting.report import run_report
from sim.reporting.traces import CURVE_BUCKETS, FORMAT_VERSION, Traces, bucket_extremes, bucket_times
from sot.errors import InputError
from sot.robots.robot import Robot
from tests.sim.runs import perfect_log, same_plan, still_motion

INFO = RunInfo("a </script><b> clip", "hrp2", "cascade", "planted", 200.0)


@pytest.fixture(scope="module")
def motion():
    return still_motion(Robot.load("hrp2"), 2.0)


@pytest.fixture
def log(motion):
    return perfect_log(motion)


def figures(text: str) -> list[dict]:
    found = re.findall(r'<script type="application/json">(.*?)</script>', text, re.DOTALL)
    return [json.loads(one) for one in found]


def test_extremes_keep_every_peak():
    values = np.zeros((1003, 2))
    values[401, 0], values[402, 0], values[1002, 1] = 5.0, -3.0, 7.0
    thin = bucket_extremes(values, 10)
    assert len(thin) == len(bucket_times(np.arange(1003.0), 10)) == 202
    assert thin.max(axis=0).tolist() == [5.0, 7.0]
    assert thin[:, 0].argmax() < thin[:, 0].argmin()  # in the order in which they came
    assert thin[:, 0].min() == -3.0


def test_extremes_leave_gaps_where_nothing_was_measured():
    values = np.r_[np.full(10, np.nan), np.nan, np.arange(9.0)]
    np.testing.assert_array_equal(bucket_extremes(values, 10), [np.nan, np.nan, 0.0, 8.0])


def test_times_of_extremes_are_those_of_the_run():
    times = bucket_times(0.001 * np.arange(12000), 12)
    assert np.diff(times) == pytest.approx(np.full(len(times) - 1, 0.006))
    assert 0.0 < times[0] < times[-1] < 12.0


def test_traces_come_back_from_their_file(motion, log, tmp_path):
    log.torque[7, 3] = 123.0
    kept = Traces.of(log, INFO, motion)
    kept.save(tmp_path / "traces.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["traces.npz"]
    read = Traces.load(tmp_path / "traces.npz")
    assert json.dumps(read.facts) == json.dumps(kept.facts)
    for name, values in kept.columns.items():
        np.testing.assert_array_equal(read.columns[name], values)
    assert read.columns["torque"][7, 3] == 123.0
    assert len(read.columns["time"]) == log.ticks <= 2 * CURVE_BUCKETS
    (left, right) = read.facts["footholds"]
    assert left[0] == left[-1] != right[0]
    assert [lane["name"] for lane in read.facts["lanes"]][-2:] == ["left foot", "right foot"]


def test_says_which_version_wrote_traces(motion, log, tmp_path):
    path = tmp_path / "traces.npz"
    kept = Traces.of(log, INFO, motion)
    Traces({**kept.facts, "version": FORMAT_VERSION + 1}, kept.columns).save(path)
    with pytest.raises(InputError, match="another version"):
        Traces.load(path)
    for content in (b"", b"nothing", path.read_bytes()[:2000]):
        path.write_bytes(content)
        with pytest.raises(InputError, match="cannot be read"):
            Traces.load(path)


def test_a_page_shows_a_run(motion, log, tmp_path):
    path = tmp_path / "report.html"
    figure = run_report(log, INFO, 1.0, motion, same_plan(motion)) | {"edits": ["the hand was raised"]}
    page.write_html(path, ["<run>"], [figure], [Traces.of(log, INFO, motion)])
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]
    text = path.read_text("utf-8")
    assert "a &lt;/script&gt;&lt;b&gt; clip" in text
    assert "<run>" not in text
    assert "the hand was raised" in text
    assert not re.search(r'<(script|link|img)[^>]*(src|href)="', text)
    drawn = figures(text)
    robot = motion.robot
    expected = 3 + 2 + 1 + robot.na + 2 + 4  # balance, forces, schedule, joints, tasks, ticks
    assert len(drawn) == expected
    assert all(name in text for name in (*robot.joints, *log.level_names, "upright"))


def test_runs_of_different_robots_and_stacks_are_compared(motion, log, tmp_path):
    other = still_motion(Robot.load("hrp2_modified"), 1.0)
    shorter = perfect_log(other)
    shorter.level_names = ("balance: com", "hands: wave")
    info = RunInfo("clip", "hrp2_modified", "cascade", "planted", 200.0)
    reports = [
        run_report(log, INFO, 1.0, motion, None) | {"edits": []},
        run_report(shorter, info, 1.0, other, None) | {"edits": []},
    ]
    page.write_html(
        tmp_path / "c.html", ["one", "two"], reports, [Traces.of(log, INFO, motion), Traces.of(shorter, info, other)]
    )
    text = (tmp_path / "c.html").read_text("utf-8")
    names = dict.fromkeys((*motion.robot.joints, *other.robot.joints))
    assert all(f"<h3>{name}</h3>" in text for name in names)
    assert len(figures(text)) == 3 + 2 + 2 + len(names) + 3 + 4
    assert all({curve["legendgroup"] for curve in shown["data"]} == {"one", "two"} for shown in figures(text)[:5])


def test_plots_show_the_limits(motion, log):
    runs = [page_plots.ShownRun("one", page_plots.RUN_COLORS[0], Traces.of(log, INFO, motion))]
    robot, joint = motion.robot, 3
    shown = {plot.title: plot.layout for plots in page_plots.limb_plots(runs).values() for plot in plots}
    layout = shown[robot.joints[joint]]
    ends = np.rad2deg([robot.lower[joint], robot.upper[joint]])
    for axis, limits in (("y", ends), ("y2", robot.effort[joint] * np.array([-1.0, 1.0]))):
        assert [shape["y0"] for shape in layout["shapes"] if shape["yref"] == axis] == pytest.approx(limits)
        low, high = layout[axis.replace("y", "yaxis")]["range"]
        assert low < limits[0] < limits[1] < high < limits[1] + 0.1 * np.ptp(limits)
    (period,) = page_plots.tick_time_plots(runs)[0].layout["shapes"]
    assert period["y0"] == period["y1"] == pytest.approx(1e6 * log.trimmed().period)
