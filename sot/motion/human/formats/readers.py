"""Reading a recorded human from a file of any supported format."""

from collections.abc import Callable
from pathlib import Path

from sot.errors import InputError
from sot.git_lfs import refuse_pointer
from sot.motion.human.capture import Capture
from sot.motion.human.formats.acclaim import read_acclaim
from sot.motion.human.formats.amass import read_amass
from sot.motion.human.formats.bvh import read_bvh
from sot.motion.human.formats.c3d import read_c3d
from sot.motion.human.formats.mvnx import read_mvnx
from sot.motion.human.formats.omomo import read_omomo
from sot.motion.human.world import to_world

READERS: dict[str, Callable[[Path], Capture]] = {
    ".amc": read_acclaim,
    ".asf": read_acclaim,
    ".bvh": read_bvh,
    ".c3d": read_c3d,
    ".mvnx": read_mvnx,
    ".npz": read_amass,
    ".pt": read_omomo,
}

FBX_ADVICE = (
    "FBX is not read: make a BVH of it in Blender, by File > Import > FBX and, with the armature selected,"
    " File > Export > Motion Capture (.bvh)"
)


def read(path: str | Path, up: str | None = None, forward: str | None = None, unit: str | None = None) -> Capture:
    """Read a motion file, chosen by its ending, into metres, Z up, first heading +X; see `world.to_world`.

    Args:
        path: The file.
        up: Its up axis, one of `world.UP_AXES`; found in the clip by default.
        forward: Its axis that becomes +X; the heading of the first frame by default.
        unit: Its unit, one of `world.METRES_PER_UNIT`; found by the length of the legs by default.

    Raises:
        InputError: no such file, an ending without a reader, or contents that are not a human motion.
    """
    path = Path(path)
    refuse_pointer(path)
    reader = READERS.get(path.suffix.lower())
    if path.suffix.lower() == ".fbx":
        raise InputError(f"{path}: {FBX_ADVICE}")
    if reader is None:
        raise InputError(f"{path}: cannot read a motion from '{path.suffix}'; supported: {', '.join(sorted(READERS))}")
    return to_world(reader(path), up, forward, unit)
