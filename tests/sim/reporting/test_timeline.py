"""The picture of a run's tasks and contacts: who comes, goes and changes, and when."""

from xml.etree import ElementTree

from sim.log import FOOT_SLIDING, RunInfo
from sim.reporting import timeline
from sot.robots.robot import Robot
from tests.sim.runs import perfect_log, still_motion

INFO = RunInfo("made-up", "hrp2", "cascade", "planted", 200.0)


def words(path):
    return [text.text for text in ElementTree.parse(path).getroot().iter("{http://www.w3.org/2000/svg}text")]


def test_nothing_changes_in_a_run_without_changes(tmp_path):
    motion = still_motion(Robot.load("hrp2"), 1.0)
    log = perfect_log(motion)
    assert not timeline.has_changes(log)
    timeline.write_timeline(tmp_path / "schedule.svg", log, INFO, motion.robot)
    assert {"balance: com", "posture: joints", "left foot", "fixed"} <= set(words(tmp_path / "schedule.svg"))


def test_a_task_that_comes_and_a_foot_that_slides_are_changes(tmp_path):
    motion = still_motion(Robot.load("hrp2"), 4.0)
    log = perfect_log(motion)
    log.level_place[:400, 1], log.level_share[:400, 1] = 0, 0.0
    assert timeline.has_changes(log)
    log = perfect_log(motion)
    log.foot_mode[300:500, 0] = FOOT_SLIDING
    assert timeline.has_changes(log)
    timeline.write_timeline(tmp_path / "schedule.svg", log, INFO, motion.robot)
    assert "sliding" in words(tmp_path / "schedule.svg")
