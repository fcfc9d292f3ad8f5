"""References that go over smoothly from one aim to the next: of a point's pose, and of the centre of mass."""

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.behaviours.manipulation.clock import VectorReference
from sot.control.pose import Pose, PoseReference
from sot.rotation import cross, rotation_of_vector

Array = np.ndarray


def fixed_reference(placement: pin.SE3) -> PoseReference:
    """A point that stays at a placement."""
    rest = np.zeros(6)
    pose = Pose(placement.translation.copy(), placement.rotation.copy(), rest, rest)
    return lambda t: pose


def fixed_place(place: Array) -> VectorReference:
    """A place (n,) that stays."""
    rest, kept = np.zeros_like(place), place.copy()
    return lambda t: (kept, rest, rest)


def closing_reference(placement: pin.SE3, velocity: Array, start: float, ramp: float) -> PoseReference:
    """A point that moves off from a placement at a time [s], and within a ramp [s] reaches a velocity (3,) [m/s]."""

    def at(t: float) -> Pose:
        since = max(t - start, 0.0)
        if since < ramp:
            way, share, rate = 0.5 * since**2 / ramp, since / ramp, 1.0 / ramp
        else:
            way, share, rate = since - 0.5 * ramp, 1.0, 0.0
        twist, change = np.zeros(6), np.zeros(6)
        twist[:3], change[:3] = share * velocity, rate * velocity
        return Pose(placement.translation + way * velocity, placement.rotation, twist, change)

    return at


def attached_reference(carrier: PoseReference, offset: pin.SE3) -> PoseReference:
    """A point that is fixed to a body that moves by a reference, at an offset in the body's axes."""

    arm, turn = offset.translation.copy(), offset.rotation.copy()

    def at(t: float) -> Pose:
        body = carrier(t)
        return Pose(*_attached(arm, turn, body.position, body.rotation, body.velocity, body.acceleration))

    return at


def placement_of(pose: Pose) -> pin.SE3:
    """A pose's place."""
    return pin.SE3(pose.rotation, pose.position)


class PoseGuide:
    """The reference of a point that is led now by this, now by that: what it was led by before fades with least jerk.

    Args:
        reference: What leads it first.
    """

    def __init__(self, reference: PoseReference) -> None:
        self._reference = reference
        self._start, self._fade = -np.inf, 0.0
        self._shift, self._turn = np.zeros(3), np.zeros(3)

    def lead_by(self, reference: PoseReference, t: float, fade: float) -> None:
        """From a time [s] on the point is led by another reference, on which it is `fade` [s] later."""
        now, new = self(t), reference(t)
        self._shift = now.position - new.position
        self._turn = pin.log3(now.rotation @ new.rotation.T)
        self._reference, self._start, self._fade = reference, t, fade

    def start_at(self, placement: pin.SE3) -> None:
        """Be at a placement, at rest, at once: where the point has been led by nothing until now."""
        self._reference, self._fade = fixed_reference(placement), 0.0

    def __call__(self, t: float) -> Pose:
        """The pose, its velocity and its acceleration at a time [s]."""
        pose = self._reference(t)
        if t >= self._start + self._fade:
            return pose
        s = (t - self._start) / self._fade
        return Pose(*_faded(s, self._fade, self._shift, self._turn, *pose))


class PlaneGuide:
    """The horizontal reference of the centre of mass: led now by this, now by that, from wherever it is.

    Beside its leader it may be shifted, by what is low-passed.

    Args:
        reference: What leads it first: ``t -> position, velocity, acceleration``, shapes (2,).
        shift_time: Time constant of the shift's low-pass [s].
    """

    def __init__(self, reference: VectorReference, shift_time: float) -> None:
        self._reference = reference
        self._coefficients = np.zeros((6, 2))
        self._start, self._duration, self._shift_time = -np.inf, 0.0, shift_time
        self._shift, self._shift_rate, self._shifted_at = np.zeros(2), np.zeros(2), 0.0

    def lead_by(self, reference: VectorReference, t: float, duration: float) -> None:
        """From a time [s] on it is led by another reference, on which it is `duration` [s] later, with least jerk."""
        now = self._unshifted(t)
        self._reference = reference
        self._begin(now, t, duration)

    def restart(self, position: Array, velocity: Array, t: float, duration: float) -> None:
        """Go to where it is led from a position and a velocity (2,), of another centre of mass than before."""
        self._begin((position - self._shift, velocity, np.zeros(2)), t, duration)

    def shift_by(self, shift: Array, t: float) -> None:
        """Lead the shift towards a value (2,) [m]."""
        self._shift_rate = (shift - self._shift) / self._shift_time
        self._shift = self._shift + (t - self._shifted_at) * self._shift_rate
        self._shifted_at = t

    @property
    def arrives_at(self) -> float:
        """When it is where it is led [s]."""
        return self._start + self._duration

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (3,) at a time [s]; the height is nought."""
        position, velocity, acceleration = self._unshifted(t)
        return (
            np.append(position + self._shift, 0.0),
            np.append(velocity + self._shift_rate, 0.0),
            np.append(acceleration, 0.0),
        )

    def _begin(self, state: tuple[Array, Array, Array], t: float, duration: float) -> None:
        """Take the quintic by which a state's distance from the reference fades; its time counts in durations."""
        p, v, a = (own - other for own, other in zip(state, self._reference(t), strict=True))
        v, a = duration * v, 0.5 * duration**2 * a
        self._coefficients = np.array(
            [p, v, a, -10.0 * p - 6.0 * v - 3.0 * a, 15.0 * p + 8.0 * v + 3.0 * a, -6.0 * p - 3.0 * v - a]
        )
        self._start, self._duration = t, duration

    def _unshifted(self, t: float) -> tuple[Array, Array, Array]:
        position, velocity, acceleration = self._reference(t)
        if t >= self._start + self._duration:
            return position, velocity, acceleration
        s, order = (t - self._start) / self._duration, np.arange(6)
        powers = s**order
        return (
            position + powers @ self._coefficients,
            velocity + (order[1:] * powers[:5]) @ self._coefficients[1:] / self._duration,
            acceleration + (order[2:] * order[1:5] * powers[:4]) @ self._coefficients[2:] / self._duration**2,
        )


@compiled
def _faded(
    s: float,
    duration: float,
    shift: Array,
    turn: Array,
    position: Array,
    rotation: Array,
    velocity: Array,
    acceleration: Array,
) -> tuple[Array, Array, Array, Array]:
    """A pose with what is left of a shift and of a turn that fade with least jerk, s being the share of their time."""
    left = 1.0 - s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    rate = -30.0 * s**2 * (1.0 - s) ** 2 / duration
    change = -60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2
    R = rotation_of_vector(left * turn)
    faded_velocity, faded_acceleration = np.empty(6), np.empty(6)
    carried, sped = R @ velocity[3:], R @ acceleration[3:]
    faded_velocity[:3] = velocity[:3] + rate * shift
    faded_velocity[3:] = rate * turn + carried
    faded_acceleration[:3] = acceleration[:3] + change * shift
    faded_acceleration[3:] = change * turn + sped + cross(rate * turn, carried)
    return position + left * shift, R @ np.ascontiguousarray(rotation), faded_velocity, faded_acceleration


@compiled
def _attached(
    arm: Array, turn: Array, position: Array, rotation: Array, velocity: Array, acceleration: Array
) -> tuple[Array, Array, Array, Array]:
    """Pose, velocity and acceleration of a point at an arm and a turn in a body's axes."""
    R = np.ascontiguousarray(rotation)
    lever, spin = R @ arm, velocity[3:]
    point_velocity, point_acceleration = velocity.copy(), acceleration.copy()
    point_velocity[:3] += cross(spin, lever)
    point_acceleration[:3] += cross(acceleration[3:], lever) + cross(spin, cross(spin, lever))
    return position + lever, R @ turn, point_velocity, point_acceleration
