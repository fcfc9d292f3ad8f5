"""Reader of recorded markers (.c3d): the joints of whoever wears a marker set that has a file in `markers/`."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.formats.c3d_file import PointFile, read_point_file
from sot.motion.human.formats.marker_set import BODIES, MarkerSet, body_rotations, joint_centres, marker_sets
from sot.motion.human.formats.text import RATE_RANGE_HZ
from sot.motion.human.human import SIDES, Remark

Array = NDArray[np.float64]

METRES_PER_UNIT = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "": 0.001}
MAX_LOST_SHARE = 0.5  # of the frames, in which a marker may be out of sight
TOLD_GAP = 0.2  # s, of a marker out of sight: shorter gaps are filled without a word

_TREE = (
    ("pelvis", ""),
    ("chest", "pelvis"),
    ("neck", "chest"),
    ("head", "neck"),
    *(
        (f"{side}_{joint}", above if above in ("pelvis", "chest") else f"{side}_{above}")
        for side in SIDES
        for joint, above in (
            ("shoulder", "chest"),
            ("elbow", "shoulder"),
            ("wrist", "elbow"),
            ("hip", "pelvis"),
            ("knee", "hip"),
            ("ankle", "knee"),
            ("toe", "ankle"),
        )
    ),
)


def read_c3d(path: str | Path) -> Capture:
    """Read markers, and place the joints among them; in metres, axes as they stand.

    Only pelvis, chest and head get rotations, from three markers each; other joints have none of their own. Markers
    that are out of sight for a while are interpolated, and a remark says so where it is long.

    Raises:
        InputError: no C3D, damaged, or markers of no known set, with those that are missing.
    """
    path = Path(path)
    file = read_point_file(path)
    if not RATE_RANGE_HZ[0] <= file.rate <= RATE_RANGE_HZ[1]:
        raise InputError(f"{path}: {file.rate:g} frames a second are not plausible")
    if file.unit.lower() not in METRES_PER_UNIT:
        raise InputError(f"{path}: counts in '{file.unit}'; known are {', '.join(filter(None, METRES_PER_UNIT))}")
    chosen = _chosen_markers(path, file)
    names = sorted({name for group in chosen.values() for name in group})
    scale = METRES_PER_UNIT[file.unit.lower()]
    seen = {name: scale * file.places[:, file.labels.index(name)] for name in names}
    places = {name: _filled(path, name, place) for name, place in seen.items()}
    joints = joint_centres(chosen, places)
    turns = {body: body_rotations([places[name] for name in chosen[body]]) for body in BODIES}
    tree = [(name, above) for name, above in _TREE if name in joints]
    order = [name for name, _ in tree]
    parents = [order.index(above if above in joints else "chest") if above else -1 for _, above in tree]
    still = np.broadcast_to(np.eye(3), (len(file.places), 3, 3))
    return Capture(
        name=path.stem,
        rate=file.rate,
        joints=tuple(order),
        parents=tuple(parents),
        positions=np.stack([joints[name] for name in order], axis=1),
        rotations=np.stack([turns.get(name, still) for name in order], axis=1),
        remarks=_remarks(seen, file.rate),
    )


def _chosen_markers(path: Path, file: PointFile) -> dict[str, list[str]]:
    """Landmark or body -> its markers, of the set that fits; those that are seldom seen do not count."""
    lost = np.isnan(file.places[:, :, 0]).mean(axis=0)
    labels = [label for label, share in zip(file.labels, lost, strict=True) if label and share <= MAX_LOST_SHARE]
    sets = marker_sets()
    best: MarkerSet = min(sets, key=lambda one: len(one.missing(labels)))
    if missing := best.missing(labels):
        known = ", ".join(one.name for one in sets)
        raise InputError(
            f"{path}: its markers are of no known set ({known}): of {best.name} it lacks {', '.join(missing)}; it has"
            f" {', '.join(labels[:60]) or 'none'}{' …' if len(labels) > 60 else ''}"
        )
    return best.chosen(labels)


def _filled(path: Path, name: str, place: Array) -> Array:
    """A marker's places (T, 3) without gaps: interpolated, and held at the ends."""
    seen = ~np.isnan(place[:, 0])
    frames = np.arange(len(place))
    if not np.abs(place[seen]).max() < 1e6:
        raise InputError(f"{path}: marker {name} is where no human is: the file is damaged")
    return np.column_stack([np.interp(frames, frames[seen], place[seen, k]) for k in range(3)])


def _remarks(seen: dict[str, Array], rate: float) -> tuple[Remark, ...]:
    """A remark for each stretch in which markers are out of sight for long."""
    lost = {name: np.isnan(place[:, 0]) for name, place in seen.items()}
    long: dict[tuple[int, int], list[str]] = {}
    for name, flags in lost.items():
        edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
        for first, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            if end - first > TOLD_GAP * rate:
                long.setdefault((first, end), []).append(name)
    return tuple(
        Remark(
            first / rate,
            end / rate,
            f"Out of sight from {first / rate:.2f} to {end / rate:.2f} s and interpolated: {', '.join(names)}.",
        )
        for (first, end), names in sorted(long.items())
    )
