"""What to say of joints under unknown names: which are missing, what may be meant, and a mapping to complete."""

from collections.abc import Mapping, Sequence
from difflib import SequenceMatcher

import numpy as np

from sot.errors import InputError, UnknownSkeletonError
from sot.motion.human.capture import Capture, find_legs
from sot.motion.human.human import SIDES

MIN_LIKENESS = 0.6  # of a name, from which on it may be meant
MAX_OFFERS = 3
MAX_TOLD = 6  # missing joints for which a message names the nearest; the mapping does so for all


def unknown_skeleton(
    capture: Capture, aliases: Mapping[str, Sequence[str]], found: Mapping[str, int], reason: str
) -> UnknownSkeletonError:
    """The error for a capture whose joints are not all known.

    Args:
        capture: Its joints.
        aliases: Canonical joint, of all that are needed, -> the names that it may have.
        found: Canonical joint -> joint of the capture, as far as they are known.
        reason: Why those that are found cannot be, if they are all there.
    """
    missing = [joint for joint in aliases if joint not in found]
    offers = {joint: _nearest(capture, joint, aliases[joint], found) for joint in missing}
    told = "; ".join(
        f"{joint} may be {' or '.join(_quoted(name) for name in names)}"
        for joint, names in list(offers.items())[:MAX_TOLD]
        if names
    )
    lacking = f"not found: {', '.join(missing)}" if missing else reason
    return UnknownSkeletonError(
        f"{capture.name}: unknown skeleton ({lacking}){'; ' if told else ''}{told}",
        _mapping_text(capture, aliases, found, offers),
    )


def _mapping_text(
    capture: Capture,
    aliases: Mapping[str, Sequence[str]],
    found: Mapping[str, int],
    offers: Mapping[str, Sequence[str]],
) -> str:
    lines = [f"# The joints of {' '.join(capture.name.split())}; complete the empty ones, and give this to --mapping."]
    for joint in aliases:
        if joint in found:
            lines.append(f"{joint} = {_quoted(capture.joints[found[joint]])}")
        else:
            may_be = f"  # may be {', '.join(map(_quoted, offers[joint]))}" if offers[joint] else ""
            lines.append(f'{joint} = ""{may_be}')
    free = [name for index, name in enumerate(capture.joints) if index not in found.values()]
    return "\n".join([*lines, f"# Its other joints: {', '.join(map(_quoted, free))}", ""])


def _quoted(name: str) -> str:
    """A name as TOML has it."""
    escaped = "".join(c if c.isprintable() and c not in '"\\' else f"\\U{ord(c):08x}" for c in name)
    return f'"{escaped}"'


def _nearest(capture: Capture, joint: str, names: Sequence[str], found: Mapping[str, int]) -> list[str]:
    """Names of the capture that may be a joint's: the bones tell those of legs, the likeness of names all others."""
    by_bones = _legs(capture).get(joint)
    if by_bones is not None and by_bones not in found.values():
        return [capture.joints[by_bones]]
    free = [name for index, name in enumerate(capture.joints) if index not in found.values()]

    def likeness(name: str) -> float:
        return max(SequenceMatcher(None, name.lower(), alias.lower()).ratio() for alias in (*names, joint))

    scored = sorted(((likeness(name), name) for name in free), reverse=True)
    return [name for score, name in scored if score >= MIN_LIKENESS][:MAX_OFFERS]


def _legs(capture: Capture) -> dict[str, int]:
    """Canonical joint -> joint of the legs, by the bones alone; sides by the first frame, which faces +X."""
    try:
        one, other = find_legs(capture)
    except InputError:
        return {}
    first = capture.positions[0]
    left, right = (one, other) if first[one.hip, 1] > first[other.hip, 1] else (other, one)
    if np.array_equal(first[one.hip], first[other.hip]):
        return {}
    return {
        f"{side}_{joint}": getattr(leg, joint)
        for side, leg in zip(SIDES, (left, right), strict=True)
        for joint in ("hip", "knee", "ankle")
    }
