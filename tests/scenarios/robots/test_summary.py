"""Robots with a name: listed without being fetched, as they are once they are."""

import subprocess

import pytest

from scenarios.robots.summary import robot_summary
from sot.robots import fetch
from sot.robots.fetch import Package
from sot.robots.robot import MODELS, Robot, robot_names, shipped_robot_names
from sot.robots.robot_file import RobotFile
from sot.robots.size import standing_height

FETCHED = sorted(set(robot_names()) - set(shipped_robot_names()))


def test_listing_fetches_nothing(monkeypatch, tmp_path):
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a list must not fetch")

    monkeypatch.setattr(subprocess, "run", refuse)
    monkeypatch.setattr(fetch, "cache_folder", lambda: tmp_path)
    assert FETCHED == ["g1", "jvrc1", "op3", "t1", "talos"]
    assert shipped_robot_names() == ("hrp2", "hrp2_modified")
    for name in robot_names():
        summary = robot_summary(name)
        assert summary.joints > 12 and summary.mass > 1.0 and summary.height > 0.3
        assert bool(summary.origin) == (name in FETCHED)


@pytest.mark.slow
@pytest.mark.parametrize("name", FETCHED)
def test_a_fetched_robot_is_as_it_is_listed(name):
    content = RobotFile(MODELS / f"{name}.toml").content["package"]
    package = Package(content["name"], content["version"], content["sha256"])
    folder = fetch.cache_folder() / f"{package.name}-{package.version}-{package.sha256[:12]}"
    if not folder.is_dir():
        pytest.skip(f"{package.name} has not been fetched")
    robot, summary = Robot.load(name), robot_summary(name)
    assert robot.na == summary.joints
    assert robot.mass == pytest.approx(summary.mass, abs=0.051)
    assert standing_height(robot) == pytest.approx(summary.height, abs=0.0051)
