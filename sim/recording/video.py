"""A run as a video (.mp4): the robot, its reference as a ghost, and the human beside it, drawn by MuJoCo."""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from sim.convert import state_to_mujoco
from sim.scene import build_model
from sot.errors import InputError
from sot.exchange.simulated_motion import SimulatedMotion
from sot.motion.human.human import SEGMENTS
from sot.robots.robot import Robot

WIDTH, HEIGHT = 1280, 720
FPS = 30
OPEN_GL = ("egl", "osmesa", "glfw")  # in the order in which they are tried: the first needs no display
MAX_GEOMS = 20_000
SAMPLES, SHADOW_SIZE = 0, 1024  # no smoothing, coarse shadows: where a processor draws, that is three times as fast
GHOST_COLOR = (0.25, 0.55, 0.95, 0.25)
HUMAN_COLOR = (0.95, 0.55, 0.15, 1.0)
HUMAN_RADIUS_M, HUMAN_OFFSET_M = 0.02, 1.0  # of its limbs; to the robot's left
LOOK_AT_SHARE = 1.1  # of the base's height
DISTANCE_HEIGHTS, AZIMUTH_DEG, ELEVATION_DEG = 4.2, 200.0, -12.0


def write_video(simulated: SimulatedMotion, robot: Robot, path: Path) -> None:
    """Write a video of a run at FPS frames per second.

    Args:
        simulated: The run.
        robot: Its robot.
        path: File to write (`.mp4`).

    Raises:
        InputError: nothing to encode or draw with.
    """
    av = _encoder()
    model = build_model(robot)
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    model.vis.quality.offsamples, model.vis.quality.shadowsize = SAMPLES, SHADOW_SIZE
    with open_gl(WIDTH, HEIGHT), av.open(str(path), "w") as file:
        drawing = _Drawing(model, robot, simulated)
        stream = file.add_stream("libx264", rate=FPS)
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        stream.time_base = Fraction(1, FPS)
        for image in drawing.frames():
            file.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        file.mux(stream.encode())
        drawing.free()


class _Drawing:
    """Draws a run's moments in the current OpenGL context."""

    def __init__(self, model: mujoco.MjModel, robot: Robot, simulated: SimulatedMotion) -> None:
        self._model, self._simulated = model, simulated
        self._data, self._ghost = mujoco.MjData(model), mujoco.MjData(model)
        self._scene, self._options = mujoco.MjvScene(model, MAX_GEOMS), mujoco.MjvOption()
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._camera = mujoco.MjvCamera()
        self._camera.distance = DISTANCE_HEIGHTS * float(robot.rest[2])
        self._camera.azimuth, self._camera.elevation = AZIMUTH_DEG, ELEVATION_DEG

    def frames(self) -> Iterator[np.ndarray]:
        """Images (HEIGHT, WIDTH, 3) of the run's moments, FPS a second."""
        image, view = np.empty((HEIGHT, WIDTH, 3), np.uint8), mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
        duration = (len(self._simulated.q) - 1) / self._simulated.rate
        for t in np.arange(int(duration * FPS) + 1) / FPS:
            self._draw(float(t))
            mujoco.mjr_render(view, self._scene, self._context)
            mujoco.mjr_readPixels(image, None, view, self._context)
            yield np.ascontiguousarray(image[::-1])

    def free(self) -> None:
        """Give the context back."""
        self._context.free()

    def _draw(self, t: float) -> None:
        tick = min(round(t * self._simulated.rate), len(self._simulated.q) - 1)
        q = self._simulated.q[tick]
        self._pose(self._data, q)
        self._camera.lookat[:] = [q[0], q[1], LOOK_AT_SHARE * q[2]]
        everything = int(mujoco.mjtCatBit.mjCAT_ALL)
        mujoco.mjv_updateScene(self._model, self._data, self._options, None, self._camera, everything, self._scene)
        first = self._scene.ngeom
        self._pose(self._ghost, self._simulated.reference[tick])
        moving = int(mujoco.mjtCatBit.mjCAT_DYNAMIC)
        mujoco.mjv_addGeoms(self._model, self._ghost, self._options, mujoco.MjvPerturb(), moving, self._scene)
        for k in range(first, self._scene.ngeom):
            self._scene.geoms[k].rgba[:] = GHOST_COLOR
        self._draw_human(t)

    def _pose(self, data: mujoco.MjData, q: np.ndarray) -> None:
        data.qpos[: len(q)], _ = state_to_mujoco(q, np.zeros(len(q) - 1))
        mujoco.mj_forward(self._model, data)

    def _draw_human(self, t: float) -> None:
        human, names = self._simulated.human, self._simulated.human_points
        if not len(human):
            return
        points = human[min(round(t * self._simulated.human_rate), len(human) - 1)] + [0.0, HUMAN_OFFSET_M, 0.0]
        for near, far in SEGMENTS.values():
            if near in names and far in names and self._scene.ngeom < self._scene.maxgeom:
                geom = self._scene.geoms[self._scene.ngeom]
                ends = points[names.index(near)], points[names.index(far)]
                color = np.array(HUMAN_COLOR, np.float32)
                capsule = mujoco.mjtGeom.mjGEOM_CAPSULE
                mujoco.mjv_initGeom(geom, capsule, np.zeros(3), np.zeros(3), np.zeros(9), color)
                mujoco.mjv_connector(geom, capsule, HUMAN_RADIUS_M, *ends)
                self._scene.ngeom += 1


def _encoder() -> Any:
    try:
        return importlib.import_module("av")
    except ImportError:
        raise InputError("mp4 needs an encoder: pip install 'humanoid-sot[video]'") from None


@contextmanager
def open_gl(width: int, height: int) -> Iterator[None]:
    """A current OpenGL context for pictures of a size in pixels, of the first library that works.

    Raises:
        InputError: none does.
    """
    for name in OPEN_GL:
        try:
            context = importlib.import_module(f"mujoco.{name}").GLContext(width, height)
            context.make_current()
            break
        except Exception:  # whatever a driver that is not there raises
            continue
    else:
        raise InputError(
            f"drawing needs OpenGL, and none of {', '.join(OPEN_GL)} works here: install libegl1 or libosmesa6"
        )
    try:
        yield
    finally:
        context.free()
