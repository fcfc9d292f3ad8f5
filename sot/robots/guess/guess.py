"""A robot file, guessed from a model: every part with its evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.feet import Feet, find_feet, sole
from sot.robots.guess.groups import Body, find_body
from sot.robots.guess.heading import find_heading, turned
from sot.robots.guess.limits import Limits, find_limits
from sot.robots.guess.points import Array, Points, find_points
from sot.robots.guess.posed_model import PosedModel
from sot.robots.guess.rest import Rest, find_rest, stands_flat
from sot.robots.guess.source import original_model


@dataclass(frozen=True)
class Guess:
    """What was found of a model.

    Attributes:
        path: the model file.
        posed: its links and joints, at rest.
        start: the configuration (nq,) in which points were found.
        yaw: by which the base was turned to look along x [rad].
        soles: side -> corners (n, 3) in the world at `start` [m].
        evidence: of every part, in the order of the robot file.
    """

    path: Path
    posed: PosedModel
    start: Array
    yaw: float
    body: Body
    points: Points
    soles: dict[str, Array]
    rest: Rest
    limits: Limits
    evidence: Sequence[Evidence]

    def points_at_rest(self) -> dict[str, Array]:
        """Operational points (3,) in the world at rest [m]."""
        return self._at_rest({name: (point.link, point.at[None]) for name, point in self.points.places.items()})

    def soles_at_rest(self) -> dict[str, Array]:
        """Corners (n, 3) of the soles in the world at rest, side -> corners [m]."""
        return self._at_rest({side: (self.body.feet[side], corners) for side, corners in self.soles.items()})

    def _at_rest(self, places: Mapping[str, tuple[int, Array]]) -> dict[str, Array]:
        """Places (n, 3) that links carry, moved from `start` to rest; the tree is at rest afterwards."""
        data, local = self.posed.data, {}
        self.posed.place(self.start)
        for name, (link, at) in places.items():
            local[name] = (at - data.xpos[link]) @ data.xmat[link].reshape(3, 3)
        self.posed.place(self.rest.qpos)
        moved = {
            name: data.xpos[link] + local[name] @ data.xmat[link].reshape(3, 3).T for name, (link, _) in places.items()
        }
        return {name: np.squeeze(at, axis=0) if len(at) == 1 else at for name, at in moved.items()}


def guess(path: Path) -> Guess:
    """Guess the robot file of a humanoid's model (MJCF or URDF).

    Raises:
        InputError: the model cannot be read, or is no humanoid.
    """
    posed = PosedModel(original_model(path))
    feet, said_feet = find_feet(posed)
    heading, said_heading = find_heading(posed, feet)
    start, said_soles = _start(posed, feet, heading.yaw)
    posed.place(start)
    body, said_body = find_body(posed, feet, heading)
    points, said_points = find_points(posed, body)
    soles = {side: sole(posed, foot)[0] for side, foot in body.feet.items()}
    limits, said_limits = find_limits(posed, body, points, path)
    rest, said_rest = find_rest(posed, body, points, start)
    posed.place(rest.qpos)
    evidence = [said_feet, said_heading, said_soles, *said_body, *said_points, *said_rest, *said_limits]
    return Guess(path, posed, start, heading.yaw, body, points, soles, rest, limits, evidence)


def _start(posed: PosedModel, feet: Feet, yaw: float) -> tuple[Array, Evidence]:
    """The model's own configuration, or the first key frame in which the soles lie flat."""
    model = posed.model
    own = [
        ("the model's own posture", model.qpos0),
        *((f"key frame {model.key(k).name}", model.key_qpos[k]) for k in range(model.nkey)),
    ]
    for name, qpos in own:
        start = turned(posed, yaw, np.array(qpos))
        posed.place(start)
        if stands_flat(posed, feet.links, feet.height):
            corners, _ = sole(posed, feet.links[0])
            long, wide = np.ptp(corners[:, 0]), np.ptp(corners[:, 1])
            found = f"{1e3 * long:.0f} × {1e3 * wide:.0f} mm, {len(corners)} corners"
            return start, Evidence("soles", found, f"what lies flat on the floor in {name}", Sureness.SURE)
    posed.place(turned(posed, yaw, model.qpos0))
    why = "the soles lie flat in no posture that the model has: what is lowest was taken"
    return turned(posed, yaw, model.qpos0), Evidence("soles", "the lowest edges", why, Sureness.UNSURE)
