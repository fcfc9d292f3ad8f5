"""Clips played as a live source would send them."""

from collections.abc import Sequence
from time import perf_counter, sleep

import numpy as np

from scenarios.inputs import clips
from sot.errors import InputError
from sot.live.clip_source import ClipSource, resampled
from sot.live.streams.address import Sender, StreamAddress, clip_for
from sot.live.streams.seams import joined, repeated
from sot.motion import read
from sot.motion.human.capture import Capture


def stream_clips(
    names: Sequence[str],
    address: StreamAddress,
    rate: float,
    start: float = 0.0,
    duration: float | None = None,
    loop: float | None = None,
    token: str = "",
) -> int:
    """Send clips one after the other in real time; the number of frames sent. See `performance` for the arguments.

    Raises:
        InputError: as of `performance`; a skeleton that the protocol cannot name, or the receiver wants another token.
    """
    capture = clip_for(address, performance(names, rate, start, duration, loop))
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


def performance(
    names: Sequence[str], rate: float, start: float = 0.0, duration: float | None = None, loop: float | None = None
) -> Capture:
    """Clips one after the other at a rate [Hz], of each `duration` from `start` on, looped for `loop` [s].

    Raises:
        InputError: no such clip, nothing of it lies there, or no seam between them is possible.
    """
    parts = [resampled(part_of(read(clips.find_clip(name)), start, duration), rate) for name in names]
    capture = joined(parts)
    return capture if loop is None else repeated(capture, loop)


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
