"""Moments of a run in one picture."""

import struct
import zlib

import numpy as np
import pytest

from sim.log import RunLog
from sim.recording.stills import HEIGHT, WIDTH, png, write_stills
from sim.recording.video import open_gl
from sot.errors import InputError
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.robots.things.thing import Thing


def pixels(data: bytes) -> np.ndarray:
    """What a PNG file holds, as `png` writes it."""
    width, height = struct.unpack(">II", data[16:24])
    begin = data.index(b"IDAT") + 4
    length = struct.unpack(">I", data[begin - 8 : begin - 4])[0]
    rows = np.frombuffer(zlib.decompress(data[begin : begin + length]), np.uint8).reshape(height, -1)
    return rows[:, 1:].reshape(height, width, 3)


def test_a_picture_keeps_its_pixels() -> None:
    image = np.random.default_rng(1).integers(0, 256, (5, 7, 3), dtype=np.uint8)
    np.testing.assert_array_equal(pixels(png(image)), image)


def test_each_moment_shows_where_robot_and_box_are(tmp_path) -> None:
    try:
        with open_gl(8, 8):
            pass
    except InputError:
        pytest.skip("nothing draws here")
    robot = Robot.load("hrp2")
    system = System(robot, [Thing.load("box", placement=(0.5, 0.0, 0.5))])
    log = RunLog.allocate(system, 3)
    log.time[:], log.q[:], log.thing_q[:] = np.arange(3.0), robot.rest, system.rest[robot.nq :]
    log.thing_q[2, 2] += 0.4
    log.ticks = 3
    path = tmp_path / "moments.png"
    write_stills(path, log, system, [0.0, 1.0, 2.0])
    image = pixels(path.read_bytes()).astype(int)
    assert image.shape == (HEIGHT, 3 * WIDTH, 3)
    first, second, third = np.split(image, 3, axis=1)
    same, moved = ((np.abs(first - other).max(axis=2) > 20).sum() for other in (second, third))
    assert np.ptp(first) > 100
    assert same < 20 and moved > 500  # the box is higher
