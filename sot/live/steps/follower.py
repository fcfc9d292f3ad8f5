"""A live reference that walks with the person."""

from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sot.control.pose import Pose
from sot.live.follower import STALE_TIME, Follower, Target
from sot.live.person import Moment, Person
from sot.live.reference import LiveReference
from sot.live.steps.footing import SteppingFooting
from sot.live.steps.person_steps import AskedStep, PersonSteps
from sot.live.steps.placement import SteppingPlacement
from sot.motion.body.coordinates import to_rotation
from sot.motion.body.limits import Limits
from sot.robots.robot import Robot

Array = NDArray[np.float64]

EXTENSION = 0.94
"""Distance from hip to ankle that the hips are lowered for, in leg lengths: a nearly straight knee lifts nothing, and
would have to bend and stretch faster than it can."""
LOWERING_ACCELERATION = 1.0
"""Vertical acceleration with which the hips are lowered before a leg would be stretched [m/s²]."""


MAX_CAP_SINKING, MAX_CAP_RISE = 0.2, 0.02
"""Speeds at which the hips sink before legs would be stretched, and rise again once they reach [m/s]: hips that went up
and down with each step would take the load off the feet, and put it on again."""


CALMING_TIME = 0.15
"""Time constant with which the pelvis follows [s]: what it turns faster takes the zero-moment point out of one sole."""
PELVIS_LAG = 2.0 * CALMING_TIME
"""Time by which it is late then [s]."""
PELVIS_TILT_SHARE = 0.5
"""Share of the person's roll and pitch of the pelvis that the robot's makes: footholds and the legs' reach are those
under a level pelvis, and what it tilts takes the zero-moment point out of one sole."""
LEG_RESERVE = 0.1
"""Part at each end of a leg joint's range that no target of the pelvis needs [rad]: balance shifts the legs further."""
PELVIS, TILT = slice(2, 6), slice(3, 5)
"""The pelvis' height and angles in the coordinates; its roll and pitch."""


class SteppingFollower(Follower):
    """A `Follower` whose robot steps where the person does.

    A moment's feet are looked at when it arrives, its body is followed when it is due: by then the robot's own steps
    are decided.

    Attributes:
        footing: the robot's feet.
        asked: all steps of the persons.
        way: when a person was where over the floor [s], (2,) [m].
    """

    footing: SteppingFooting
    asked: list[AskedStep]
    way: list[tuple[float, Array]]

    def _new_reference(self, robot: Robot, limits: Limits) -> LiveReference:
        self.footing = SteppingFooting(robot)
        self._cap = EXTENSION * self._build.leg + float(self._build.ankles[2])
        self._calm, self._calm_rate, self._calm_at = np.zeros(4), np.zeros(4), -np.inf
        self._hips_at, self._highest = -np.inf, np.inf
        self.asked, self.way = [], []
        self._moments: deque[tuple[float, Moment, float]] = deque()
        return LiveReference(robot, limits, footing=self.footing)

    def _meet(self, person: Person) -> None:
        self._steps = PersonSteps(person.leg)
        self._over_feet: SteppingPlacement | None = None
        self._moments.clear()
        self.footing.meet(self._build.leg / person.leg)

    def _start_anew(self) -> None:
        assert self._person is not None
        self._meet(self._person)

    def _follow(self, moment: Moment, due: float) -> None:
        self._steps(moment, due)
        if self._over_feet is None:
            assert self._person is not None
            turn = self.footing.face(self._steps.stands)
            self._over_feet = SteppingPlacement(self._build, self._person, turn)
        while self._steps.asked:
            self.asked.append(self._steps.asked.popleft())
            self.footing.asked.append(self.asked[-1])
        self.way.append((due, self.footing.scale * moment.points["waist"][:2]))
        self._moments.append((due, moment, self._steps.sense.level))

    def _take_due(self, t: float) -> None:
        while self._moments and self._moments[0][0] <= t + 1e-9:
            due, moment, level = self._moments.popleft()
            feet = self.footing.poses(self.reference.horizon)
            assert self._over_feet is not None
            targets = self._over_feet(moment, level, feet)
            self._body.put_feet(self._feet_under(targets.hips))
            elapsed = due - (self._last or due)
            sunk = min(self._cap, self._hips_height) - MAX_CAP_SINKING * elapsed
            self._cap = min(max(self._highest_hips(), sunk), self._cap + MAX_CAP_RISE * elapsed)
            targets.hips[2] = min(targets.hips[2], self._cap)
            self._future.append(self._calmed(self._solved(targets, due)))
        super()._take_due(t)

    def _make_knot(self, t: float) -> None:
        self._highest_hips()  # the pelvis as it is when the plan is new
        super()._make_knot(t)

    def _target_limits(self, limits: Limits) -> Limits:
        """The robot's, but with LEG_RESERVE at the ends of the legs' ranges."""
        lower, upper = limits.lower.copy(), limits.upper.copy()
        legs = 6 + np.array(self.robot.groups["legs"], dtype=int)
        lower[legs] = np.minimum(lower[legs] + LEG_RESERVE, self.reference.rest[legs])
        upper[legs] = np.maximum(upper[legs] - LEG_RESERVE, self.reference.rest[legs])
        return replace(limits, lower=lower, upper=upper)

    def _tilted_less(self, y: Array) -> Array:
        level = y.copy()
        level[TILT] *= PELVIS_TILT_SHARE
        return level

    def _feet_under(self, hips: Array) -> dict[str, Pose]:
        """The feet once the pelvis has followed, moved with the hips from their planned place to a place (3,) [m].

        Balance has the hips elsewhere than the person. A target whose legs reach from there to the feet, in the air or
        not, has no tilt or turn of the pelvis with which a foot could not land.
        """
        t = self.reference.horizon + PELVIS_LAG
        later, places = self.footing.com_ahead
        ahead = [np.interp(t - self.footing.planned_at, later, column) for column in places.T]
        shift = np.append(hips[:2] - (ahead + self._hips_beside_com), 0.0)
        return {foot: pose._replace(position=pose.position + shift) for foot, pose in self.footing.poses(t).items()}

    @property
    def _hips_beside_com(self) -> Array:
        """Where the middle of the hips is now, from the centre of mass over the floor (2,) [m]."""
        y = self.reference.now
        return np.asarray((y[:3] + to_rotation(y[None, 3:6])[0] @ self._build.hips)[:2] - self.footing.com[0])

    def _calmed(self, target: Target) -> Target:
        """A target whose pelvis, but for its place, follows as a critically damped oscillator does."""
        y, velocity = target.y.copy(), target.velocity.copy()
        elapsed = target.due - self._calm_at
        self._calm_at = target.due
        if not elapsed < STALE_TIME:
            self._calm, self._calm_rate = self.reference.now[PELVIS].copy(), np.zeros(4)
        else:
            share, off = np.exp(-elapsed / CALMING_TIME), self._calm - y[PELVIS]
            slope = self._calm_rate + off / CALMING_TIME
            self._calm = y[PELVIS] + share * (off + elapsed * slope)
            self._calm_rate = share * (self._calm_rate - elapsed * slope / CALMING_TIME)
        y[PELVIS], velocity[PELVIS] = self._calm, self._calm_rate
        y[2] = min(y[2], self._cap - self._hips_above_base)
        return replace(target, y=y, velocity=velocity)

    @property
    def _hips_above_base(self) -> float:
        """How much higher the middle of the hips is than the base now [m]."""
        return float((to_rotation(self.reference.now[None, 3:6])[0] @ self._build.hips)[2])

    @property
    def _hips_height(self) -> float:
        """How high it is now [m]."""
        return float(self.reference.now[2]) + self._hips_above_base

    def _highest_hips(self) -> float:
        """How high the hips may be so that no leg has to be longer than it is while they are lowered [m]: by the last
        plan of the centre of mass, and as the pelvis was then."""
        if self._hips_at != self.footing.planned_at:
            self._hips_at, self._highest = self.footing.planned_at, self._hips_in_reach()
        return self._highest

    def _hips_in_reach(self) -> float:
        y, hip_width = self.reference.now, self.footing.reach.hip_width
        base, middle = to_rotation(y[None, 3:6])[0], self._hips_beside_com
        later, places = self.footing.com_ahead
        leg, highest = EXTENSION * self._build.leg, np.inf
        for sign, foot in zip((0.5, -0.5), self.robot.feet, strict=True):
            hip = places + middle + sign * hip_width * base[:2, 1]
            far = np.linalg.norm(hip - self.footing.places_ahead(foot), axis=1)
            reached = self._build.ankles[2] + np.sqrt(np.maximum(leg**2 - far**2, 0.0))
            highest = min(highest, float((reached + 0.5 * LOWERING_ACCELERATION * later**2).min()))
        return highest

    @property
    def _rest(self) -> Array:
        """Coordinates (nv,) of the safe posture over the feet as they stand, as high as both legs reach."""
        rest, build = self.reference.rest.copy(), self._build
        stands = list(self.footing.stands.values())
        turned = self.footing.mean_heading(self.reference.now[5])
        rest[5] += turned
        rest[2] = min(rest[2], self._highest_hips() - float(build.hips[2]))
        offset = self.reference.rest[:2] - build.ankles[:2]
        cosine, sine = np.cos(turned), np.sin(turned)
        rest[:2] = (
            np.mean([(at.x, at.y) for at in stands], axis=0) + np.array([[cosine, -sine], [sine, cosine]]) @ offset
        )
        return rest
