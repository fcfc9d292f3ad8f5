"""A live run shown while it runs: robot, reference, human and curves in rerun's viewer."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from scenarios import viewer
from sim.recording.bodies import body_poses
from sim.recording.columns import COLORS, TIMELINE
from sim.recording.shapes import read_shapes
from sim.recording.visuals import BONES, SIDE_DISTANCE
from sot.live.follower import Follower

Array = NDArray[np.float64]

PICTURE_RATE = 25.0
"""Pictures a second [Hz]."""


class LiveView:
    """Sends a picture now and then: the robot in the middle, the human to its right, the reference to its left.

    Args:
        stream: of rerun, which somebody watches.
    """

    def __init__(self, stream: rr.RecordingStream) -> None:
        self._stream = stream
        self._next = 0.0
        self._bodies: list[str] = []

    def __call__(self, t: float, q: Array, follower: Follower) -> None:
        """Send a picture of a time [s] if one is due; q is the robot's configuration (nq,)."""
        if t < self._next:
            return
        if not self._bodies:
            self._send_shapes(follower)
        self._next = t + 1.0 / PICTURE_RATE
        stream = self._stream
        stream.set_time(TIMELINE, duration=t)
        reference = follower.reference.sample(t)
        for entity, configuration in (("robot", q), ("reference", reference.q)):
            positions, rotations = body_poses(follower.robot, self._bodies, configuration[None])
            for k, body in enumerate(self._bodies):
                stream.log(
                    f"world/{entity}/{body}", rr.Transform3D(translation=positions[k, 0], mat3x3=rotations[k, 0])
                )
        points = next((targets.points for due, targets in reversed(follower.shown) if due <= t), None)
        if points is not None:
            strips = [np.stack([points[near], points[far]]) for near, far in BONES]
            stream.log("world/human", rr.LineStrips3D(strips, colors=[COLORS["human"]], radii=[0.018]))
        stream.log("curves/error_rad", rr.Scalars(float(np.abs(q[7:] - reference.q[7:]).max())))
        if follower.frame_times:
            last = follower.frame_times[-1]
            stream.log("curves/frame_ms", rr.Scalars(1e3 * (last.solved - last.taken)))

    def _send_shapes(self, follower: Follower) -> None:
        """What stays the same: the shapes of robot and reference, and who stands where."""
        shapes = read_shapes(follower.robot)
        self._bodies = sorted({shape.body for shape in shapes})
        stream = self._stream
        stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for entity, side, ghost in (("robot", 0.0, None), ("reference", 1.0, COLORS["ghost"])):
            stream.log(f"world/{entity}", rr.Transform3D(translation=[0.0, side * SIDE_DISTANCE, 0.0]), static=True)
            for k, shape in enumerate(shapes):
                half, color = shape.half_sizes, ghost or shape.color
                pose: dict[str, Any] = {
                    "centers": [shape.position],
                    "quaternions": [rr.Quaternion(xyzw=shape.quaternion)],
                }
                archetype: rr.AsComponents
                if shape.kind == "box":
                    archetype = rr.Boxes3D(half_sizes=[half], colors=[color], fill_mode="solid", **pose)
                elif shape.kind == "ellipsoid":
                    archetype = rr.Ellipsoids3D(half_sizes=[half], colors=[color], fill_mode="solid", **pose)
                else:  # a capsule is shown as a cylinder with an ellipsoid's radius: rerun's starts at one end
                    archetype = rr.Cylinders3D(
                        lengths=[2.0 * half[2]], radii=[half[0]], colors=[color], fill_mode="solid", **pose
                    )
                stream.log(f"world/{entity}/{shape.body}/{k}", archetype, static=True)
        stream.log("world/human", rr.Transform3D(translation=[0.0, -SIDE_DISTANCE, 0.0]), static=True)


@contextmanager
def shown_live(tell: Callable[[str], object]) -> Iterator[LiveView]:
    """A view in a window of its own; where there is no display, on a page, as long as the context lasts.

    Args:
        tell: told where that page is.
    """
    stream = rr.RecordingStream("humanoid-sot live")
    if viewer.has_display():
        stream.spawn()
        yield LiveView(stream)
        return
    with viewer.stream_server() as (into, page):
        stream.connect_grpc(into)
        tell(f"no display to open a window on: watch at {page}")
        try:
            yield LiveView(stream)
        finally:
            stream.disconnect()
