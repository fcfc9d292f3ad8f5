"""References that go over smoothly from one aim to the next: of a point's pose, and of the centre of mass."""

import numpy as np
import pinocchio as pin

from sot.control.pose import Pose, PoseReference

Array = np.ndarray


def fixed_reference(placement: pin.SE3) -> PoseReference:
    """A point that stays at a placement."""
    rest = np.zeros(6)
    pose = Pose(placement.translation.copy(), placement.rotation.copy(), rest, rest)
    return lambda t: pose


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

    def at(t: float) -> Pose:
        body = carrier(t)
        arm = body.rotation @ offset.translation
        turn, change = body.velocity[3:], body.acceleration[3:]
        velocity, acceleration = body.velocity.copy(), body.acceleration.copy()
        velocity[:3] += np.cross(turn, arm)
        acceleration[:3] += np.cross(change, arm) + np.cross(turn, np.cross(turn, arm))
        return Pose(body.position + arm, body.rotation @ offset.rotation, velocity, acceleration)

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
        left, rate, change = _least_jerk_fade((t - self._start) / self._fade, self._fade)
        turn = pin.exp3(left * self._turn)
        velocity, acceleration = np.empty(6), np.empty(6)
        velocity[:3] = pose.velocity[:3] + rate * self._shift
        acceleration[:3] = pose.acceleration[:3] + change * self._shift
        carried = turn @ pose.velocity[3:]
        velocity[3:] = rate * self._turn + carried
        acceleration[3:] = change * self._turn + turn @ pose.acceleration[3:] + np.cross(rate * self._turn, carried)
        return Pose(pose.position + left * self._shift, turn @ pose.rotation, velocity, acceleration)


class PlaneGuide:
    """The horizontal reference of the centre of mass: it goes to a goal with least jerk, from wherever it is.

    Beside the goal it may be shifted, by what is low-passed.

    Args:
        start: Where it is first (2,) [m].
        shift_time: Time constant of the shift's low-pass [s].
    """

    def __init__(self, start: Array, shift_time: float) -> None:
        self.goal = np.array(start, dtype=float)
        self._coefficients = np.zeros((6, 2))
        self._coefficients[0] = self.goal
        self._start, self._duration, self._shift_time = 0.0, 0.0, shift_time
        self._shift, self._shift_rate, self._shifted_at = np.zeros(2), np.zeros(2), 0.0

    def lead_to(self, goal: Array, t: float, duration: float) -> None:
        """Go to a goal (2,) [m], at rest there `duration` [s] after the time t [s]."""
        self._begin(*self._unshifted(t), goal, t, duration)

    def restart(self, position: Array, velocity: Array, t: float, duration: float) -> None:
        """Go to the present goal from a position and a velocity (2,), of another centre of mass than before."""
        self._begin(position - self._shift, velocity, np.zeros(2), self.goal, t, duration)

    def shift_by(self, shift: Array, t: float) -> None:
        """Lead the shift towards a value (2,) [m]."""
        self._shift_rate = (shift - self._shift) / self._shift_time
        self._shift = self._shift + (t - self._shifted_at) * self._shift_rate
        self._shifted_at = t

    @property
    def arrives_at(self) -> float:
        """When it is at its goal [s]."""
        return self._start + self._duration

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (3,) at a time [s]; the height is nought."""
        position, velocity, acceleration = self._unshifted(t)
        return (
            np.append(position + self._shift, 0.0),
            np.append(velocity + self._shift_rate, 0.0),
            np.append(acceleration, 0.0),
        )

    def _begin(self, p: Array, v: Array, a: Array, goal: Array, t: float, duration: float) -> None:
        """Take the quintic from a state to rest at the goal; its time counts in shares of the duration."""
        goal = np.array(goal, dtype=float)
        v, a, way = duration * v, duration**2 * a, goal - p
        self._coefficients = np.array(
            [
                p,
                v,
                0.5 * a,
                10.0 * way - 6.0 * v - 1.5 * a,
                -15.0 * way + 8.0 * v + 1.5 * a,
                6.0 * way - 3.0 * v - 0.5 * a,
            ]
        )
        self.goal, self._start, self._duration = goal, t, duration

    def _unshifted(self, t: float) -> tuple[Array, Array, Array]:
        rest = np.zeros(2)
        if t >= self._start + self._duration:
            return self.goal, rest, rest
        s = (t - self._start) / self._duration
        powers = s ** np.arange(6)
        order = np.arange(6)
        position = powers @ self._coefficients
        velocity = (order[1:] * powers[:5]) @ self._coefficients[1:] / self._duration
        acceleration = (order[2:] * order[1:5] * powers[:4]) @ self._coefficients[2:] / self._duration**2
        return position, velocity, acceleration


def _least_jerk_fade(share: float, duration: float) -> tuple[float, float, float]:
    """What is left of something that fades from 1 to 0 with least jerk, and its first two derivatives."""
    s = min(max(share, 0.0), 1.0)
    left = 1.0 - s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    rate = -30.0 * s**2 * (1.0 - s) ** 2 / duration
    change = -60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2
    return left, rate, change
