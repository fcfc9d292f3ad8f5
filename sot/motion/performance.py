"""What a report and a recording ask of how a reference came from a human: a plan answers, and so does a live run."""

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.flight import Flight
from sot.motion.feet.travel import Footfall
from sot.motion.human.human import Human
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]


class Way(Protocol):
    """A human's steps through the room, and what became of them; the attributes are those of a `Travel`."""

    @property
    def footfalls(self) -> Sequence[Footfall]:
        """Of the steps that count as such."""
        ...

    @property
    def path(self) -> float:
        """Length of the human's way through the room in the robot's size, not scaled otherwise [m]."""
        ...

    @property
    def scale(self) -> float:
        """Length of the way that was asked of the robot over that."""
        ...


class Performance(Protocol):
    """A robot's motion and the human whom it follows; the attributes are those of `sot.motion.plan.Plan`."""

    @property
    def motion(self) -> Motion:
        """What the robot shall do."""
        ...

    @property
    def human(self) -> Human:
        """The human in the robot's size and place, on the motion's time line."""
        ...

    @property
    def start(self) -> float:
        """Where the motion begins to show the human [s]."""
        ...

    @property
    def end(self) -> float:
        """Where it ends to [s]."""
        ...

    @property
    def clock(self) -> Array:
        """(n,) the motion's time at the human's frames [s]."""
        ...

    @property
    def heading(self) -> Array:
        """(n,) which way the human faced at its frames, in the clip and not as the robot's feet have it turn [rad]."""
        ...

    @property
    def travel(self) -> Way | None:
        """Steps and footholds, of feet that may step."""
        ...

    @property
    def flights(self) -> Sequence[Flight]:
        """When the human has both feet off the floor."""
        ...

    @property
    def retarget(self) -> Mapping[str, float | None]:
        """Figures of the report."""
        ...

    @property
    def speed_min(self) -> float:
        """The slowest speed, over the human's own."""
        ...

    @property
    def added_time(self) -> float:
        """Time that slowing down adds [s]."""
        ...

    @property
    def remarks(self) -> Sequence[str]:
        """What the robot does otherwise than the human, a sentence each."""
        ...
