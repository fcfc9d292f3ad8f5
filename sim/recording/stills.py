"""Moments of a run with things, side by side in one picture (.png), drawn by MuJoCo."""

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from sim.log import RunLog
from sim.recording.video import MAX_GEOMS, open_gl
from sim.world import World
from sot.robots.system import System
from sot.whole_file import atomic_write

Array = np.ndarray

WIDTH, HEIGHT = 480, 640  # pixels, of a moment
DISTANCE_HEIGHTS, ELEVATION_DEG = 4.2, -12.0
LOOK_AT_SHARE = 0.9  # of the base's height at the start


def write_stills(path: Path, log: RunLog, system: System, times: Sequence[float], azimuth: float = 125.0) -> None:
    """Draw a run at some moments, side by side, seen from where the robot is.

    Args:
        path: File to write (`.png`).
        log: Rows of the run.
        system: The robot and the things as they were simulated.
        times: The moments [s].
        azimuth: From where it is seen, relative to where the robot's waist faces [deg]: 180 is from the front.

    Raises:
        InputError: nothing to draw with.
    """
    world = World(system.robot, max(log.period, 1e-3), things=system.things)
    model = world.model
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    images = []
    with open_gl(WIDTH, HEIGHT):
        scene, context = (
            mujoco.MjvScene(model, MAX_GEOMS),
            mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100),
        )
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
        for t in times:
            row = min(int(np.searchsorted(log.time, t)), len(log.time) - 1)
            world.reset(np.concatenate([log.q[row], log.thing_q[row]]))
            camera = _camera(world, azimuth)
            everything = int(mujoco.mjtCatBit.mjCAT_ALL)
            mujoco.mjv_updateScene(model, world.data, mujoco.MjvOption(), None, camera, everything, scene)
            view, image = mujoco.MjrRect(0, 0, WIDTH, HEIGHT), np.empty((HEIGHT, WIDTH, 3), np.uint8)
            mujoco.mjr_render(view, scene, context)
            mujoco.mjr_readPixels(image, None, view, context)
            images.append(image[::-1])
        context.free()
    with atomic_write(path) as place:
        Path(place).write_bytes(png(np.concatenate(images, axis=1)))


def png(image: Array) -> bytes:
    """A picture (height, width, 3) of bytes, red, green and blue, as a PNG file."""
    height, width, _ = image.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), image.reshape(height, -1)], axis=1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def _camera(world: World, azimuth: float) -> mujoco.MjvCamera:
    """A camera that looks at the robot's waist."""
    q, _ = world.state()
    camera = mujoco.MjvCamera()
    x, y, z, w = q[3:7]
    heading = np.degrees(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    height = float(world.robot.rest[2])
    camera.distance, camera.elevation = DISTANCE_HEIGHTS * height, ELEVATION_DEG
    camera.azimuth = float(heading) + azimuth
    camera.lookat[:] = [q[0], q[1], LOOK_AT_SHARE * height]
    return camera
