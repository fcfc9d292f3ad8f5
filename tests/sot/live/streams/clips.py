"""A short clip and its frames, for streams."""

from functools import lru_cache

from scenarios.inputs import clips
from sot.live.clip_source import ClipSource
from sot.live.frame import Frame
from sot.live.streams.address import StreamAddress, clip_for
from sot.motion import read
from sot.motion.human.capture import Capture


@lru_cache
def groove() -> Capture:
    """The shipped clip."""
    return read(clips.find_clip("groove"))


def frames(scheme: str, seconds: float, rate: float = 50.0) -> list[Frame]:
    """Frames of the clip's first seconds, with the joints that a protocol names."""
    source = ClipSource(clip_for(StreamAddress(scheme, "127.0.0.1", 1), groove()), rate)
    return [*source.poll(0.0), *source.poll(seconds)]
