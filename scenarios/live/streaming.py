"""A clip played as a live source would send it."""

from time import perf_counter, sleep

import numpy as np

from scenarios.inputs import clips
from sot.errors import InputError
from sot.live.clip_source import ClipSource
from sot.live.streams.address import Sender, StreamAddress, clip_for
from sot.motion import read
from sot.motion.human.capture import Capture


def stream_clip(
    clip: str, address: StreamAddress, rate: float, start: float = 0.0, duration: float | None = None, token: str = ""
) -> int:
    """Send a clip in real time; the number of frames sent.

    Raises:
        InputError: no such clip, nothing of it lies there, an unknown skeleton, or the receiver wants another token.
    """
    capture = clip_for(address, part_of(read(clips.find_clip(clip)), start, duration))
    source, sender = ClipSource(capture, rate), Sender(address, token)
    sent, began = 0, perf_counter()
    try:
        while not source.ended:
            for frame in source.poll(perf_counter() - began):
                sender.send(frame)
                sent += 1
            sleep(max(0.0, sent / rate - (perf_counter() - began)))
        sender.check_refused()
    finally:
        sender.close()
    return sent


def part_of(capture: Capture, start: float, duration: float | None) -> Capture:
    """A part of a capture, from `start` for `duration` [s].

    Raises:
        InputError: nothing lies there.
    """
    first = round(start * capture.rate)
    last = capture.frames if duration is None else min(capture.frames, first + round(duration * capture.rate) + 1)
    if last - first < 2:
        raise InputError(f"{capture.name}: nothing from {start:g} s; the clip lasts {capture.duration:.2f} s")
    rows = np.arange(first, last)
    return Capture(
        capture.name,
        capture.rate,
        capture.joints,
        capture.parents,
        capture.positions[rows],
        capture.rotations[rows],
        capture.zero_pose,
    )
