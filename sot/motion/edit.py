"""Edits of a dance: x_n(t) = x_o(t) + x_m(t) on an axis of a point or on a joint, Ramos IV-B."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from sot.control.pose import AXIS_NAMES, Pose, PoseReference
from sot.errors import InputError
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]
JointReference = Callable[[float], tuple[Array, Array, Array]]

DEFAULT_EASE = 0.3
"""Time in which an edit eases in and out, unless it says otherwise [s]."""
OFFSET_SAMPLE_RATE = 1000.0
"""Rate at which an edit's offset is sampled [Hz]."""
REST_CONDITIONS = [(1, 0.0), (2, 0.0)]


@dataclass(frozen=True)
class Edit:
    """One change of a dance, in the time of the motion and its recording; one of `by`, `through` and `target` is given.

    Attributes:
        of: an operational point of the robot, or one of its joints.
        axis: of a point, one of `AXIS_NAMES` (turns about the world's axes); None for a joint or a target.
        by: what is added [m, rad], constant or a function of time, from `start` to `end` with a smooth way in and out.
        through: way-points (time, what is added) [s; m, rad] on a spline that takes `ease` to come and to go.
        target: where the point goes, in the world [m].
        start, end: when it happens [s]; way-points have their own times.
        ease: how long the way in and the way out take [s].
        limb_only: whether the limb does it alone, and the rest of the body does not help.
        source: where it was written, for messages.

    Raises:
        InputError: anything that makes no sense without knowing the robot and the motion.
    """

    of: str
    axis: str | None = None
    by: float | Callable[[float], float] | None = None
    through: Sequence[tuple[float, float]] | None = None
    target: tuple[float, float, float] | None = None
    start: float | None = None
    end: float | None = None
    ease: float = DEFAULT_EASE
    limb_only: bool = False
    source: str = ""

    def __post_init__(self) -> None:
        changes = [name for name in ("by", "through", "target") if getattr(self, name) is not None]
        if len(changes) != 1:
            raise self.error(f"give one of by, through and target, not {' and '.join(changes) or 'none'}")
        if self.axis is not None and self.axis not in AXIS_NAMES:
            raise self.error(f"{self.of} has no axis '{self.axis}': choose one of {', '.join(AXIS_NAMES)}")
        if self.limb_only and self.target is None and self.axis is None:
            raise self.error("only points have a limb that moves them: leave limb_only out")
        if self.target is not None and self.axis is not None:
            raise self.error("a target is a place, x, y and z: leave the axis out")
        if not 0.0 < self.ease < np.inf:
            raise self.error(f"ease is {self.ease:g} s, and has to be more than nothing")
        if self.through is None:
            if self.start is None or self.end is None:
                raise self.error("when? It needs a start and an end [s]")
        elif self.start is not None or self.end is not None:
            raise self.error("way-points have their own times: leave the start and the end out")
        elif not self.through or np.any(np.diff([t for t, _ in self.through]) <= 0.0):
            raise self.error("way-points (time, value) have to follow one another in time")
        start, end = self.span
        if not start < end:  # nan too
            raise self.error(f"ends at {end:g} s, not after it starts at {start:g} s")

    @property
    def span(self) -> tuple[float, float]:
        """Start and end of the change [s]."""
        if self.through is not None:
            return self.through[0][0] - self.ease, self.through[-1][0] + self.ease
        assert self.start is not None and self.end is not None
        return self.start, self.end

    @property
    def rows(self) -> tuple[int, ...]:
        """Which of `AXIS_NAMES` it changes, by number; none for a joint."""
        if self.target is not None:
            return (0, 1, 2)
        return () if self.axis is None else (AXIS_NAMES.index(self.axis),)

    def error(self, what: str) -> InputError:
        """Error that says where the edit was written and what is wrong with it."""
        return InputError(f"{self.source or f'edit of {self.of}'}: {what}")

    def check(self, robot: Robot, duration: float = np.inf) -> None:
        """Check that the robot has the edited point or joint, and that the edit lies within the duration [s].

        Raises:
            InputError: they have not.
        """
        if not self.rows:
            if self.of in robot.points:
                raise self.error(f"which axis of {self.of}? Choose one of {', '.join(AXIS_NAMES)}")
            if self.of not in robot.joints:
                raise self.error(f"{robot.name} has no joint '{self.of}': it has {', '.join(robot.joints)}")
        elif self.of not in robot.points:
            raise self.error(f"{robot.name} has no point '{self.of}': it has {', '.join(robot.points)}")
        start, end = self.span
        if start < 0.0 or end > duration:
            raise self.error(f"goes from {start:g} to {end:g} s, the motion from 0 to {duration:g} s: move it inside")

    def overlaps(self, other: "Edit") -> bool:
        """Whether both change the same thing at the same time."""
        (start, end), (begins, ends) = self.span, other.span
        same = self.of == other.of and (not self.rows or bool(set(self.rows) & set(other.rows)))
        return same and start < ends and begins < end


class Offset(NamedTuple):
    """x_m, ẋ_m and ẍ_m at one time, each of shape (k,)."""

    value: Array
    rate: Array
    acceleration: Array


@dataclass(frozen=True)
class SampledOffset:
    """Offset x_m(t) of an edit as samples, so that no function of a user is called while the robot dances.

    Attributes:
        start: time of the first sample [s].
        samples: (T, 3, k) value, rate and acceleration of what is added in each of k axes, at `OFFSET_SAMPLE_RATE`.
    """

    start: float
    samples: Array

    @classmethod
    def of(cls, edit: Edit, motion: Motion) -> "SampledOffset":
        """Sample an edit of a motion.

        Raises:
            InputError: its function gives something else than finite numbers.
        """
        start, end = edit.span
        times = start + np.arange(round((end - start) * OFFSET_SAMPLE_RATE) + 1) / OFFSET_SAMPLE_RATE
        if edit.through is not None:
            knots = np.array([(start, 0.0), *edit.through, (end, 0.0)])
            value = make_interp_spline(*knots.T, k=5, bc_type=(REST_CONDITIONS, REST_CONDITIONS))(times)[:, None]
        else:
            way = min(edit.ease, 0.5 * (end - start))
            share = minimum_jerk((times - start) / way) * minimum_jerk((end - times) / way)
            value = share[:, None] * _full_offset(edit, motion, times)
        if not np.isfinite(value).all():
            raise edit.error("what it adds is not always a finite number")
        rate = np.gradient(value, 1.0 / OFFSET_SAMPLE_RATE, axis=0)
        return cls(start, np.stack([value, rate, np.gradient(rate, 1.0 / OFFSET_SAMPLE_RATE, axis=0)], axis=1))

    def __call__(self, t: float) -> Offset:
        """Offset at a time [s]: zero before and after the edit."""
        x = (t - self.start) * OFFSET_SAMPLE_RATE
        k = int(x)
        if not 0.0 <= x < len(self.samples) - 1:
            return Offset(*np.zeros(self.samples.shape[1:]))
        return Offset(*(self.samples[k] + (x - k) * (self.samples[k + 1] - self.samples[k])))


def _full_offset(edit: Edit, motion: Motion, times: Array) -> Array:
    """Offset without easing in and out (T, k)."""
    if edit.target is not None:
        path = motion.pose(edit.of)
        return np.array([np.array(edit.target) - path(t).position for t in times.tolist()])
    if callable(edit.by):
        try:
            return np.array([[float(edit.by(t))] for t in times.tolist()])
        except (TypeError, ValueError) as error:
            raise edit.error(f"its function gives no number: {error}") from error
    return np.full((len(times), 1), edit.by)


def edited_point_reference(
    reference: PoseReference, changes: Sequence[tuple[tuple[int, ...], SampledOffset]]
) -> PoseReference:
    """x_n = x_o + x_m of a point: a reference with changes, each of some rows of `AXIS_NAMES`.

    Turns are about the world's axes, in the order of the changes, after the reference's own.
    """

    def at(t: float) -> Pose:
        pose = reference(t)
        shift, turns = np.zeros((3, 6)), []
        for rows, change in changes:
            moved = change(t)
            if rows[0] < 3:
                shift[:, rows] += moved
            else:
                turns.append((rows[0], moved))
        position, rotation = pose.position + shift[0, :3], pose.rotation
        velocity, acceleration = pose.velocity + shift[1], pose.acceleration + shift[2]
        for row, moved in turns:
            axis = np.eye(3)[row - 3]
            turn = pin.exp3(moved.value * axis)
            spin = moved.rate * axis
            # ω_n = θ̇ n + R(θ) ω, and its derivative.
            carried = turn @ velocity[3:]
            rotation = turn @ rotation
            acceleration[3:] = moved.acceleration * axis + np.cross(spin, carried) + turn @ acceleration[3:]
            velocity[3:] = spin + carried
        return Pose(position, rotation, velocity, acceleration)

    return at


def edited_joint_reference(
    robot: Robot, reference: JointReference, changes: Mapping[str, Sequence[SampledOffset]]
) -> JointReference:
    """x_n = x_o + x_m of joints: a reference of all joints with changes of some of them, by name."""
    parts = [(robot.joints.index(joint), change) for joint, some in changes.items() for change in some]

    def at(t: float) -> tuple[Array, Array, Array]:
        wanted = np.array(reference(t))
        for joint, change in parts:
            wanted[:, joint] += np.ravel(change(t))
        return wanted[0], wanted[1], wanted[2]

    return at
