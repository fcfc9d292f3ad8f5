"""The divergent component of a robot's motion, and where feet catch it."""

from collections.abc import Iterable

import numpy as np
import pinocchio as pin

from sot.behaviours.displacement import Displacement
from sot.behaviours.support_height import divergence_rate
from sot.control.tick import Tick
from sot.motion.feet.footholds import SOLE_CLEARANCE, LegReach
from sot.motion.trajectory import Reference
from sot.polygon import Polygon
from sot.robots.robot import Robot

Array = np.ndarray

ZMP_MARGIN = 0.01
"""Distance from the support's edges that the zero-moment point keeps in predictions [m]."""


class Capture:
    """Where ξ = c + ċ/ω is, where it will be, and which places of a foot catch it.

    Args:
        robot: The robot.
        reference: What it does.

    Attributes:
        reach: Of its legs.
        early: Feet that stand before the plan has them stand, and the places (3,) at which it will [m].
    """

    def __init__(self, robot: Robot, reference: Reference) -> None:
        self._robot, self._reference, self._planned_places = robot, reference, reference.feet
        self.reach, self.early = LegReach.of(robot), dict[str, Array]()
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        # What points to the robot's left, seen from its feet.
        self._left = {foot: data.oMf[robot.point(foot)].rotation.T @ (0.0, 1.0, 0.0) for foot in robot.feet}

    def dcm_and_deviation(self, tick: Tick) -> tuple[Array, Array]:
        """ξ with angular momentum (2,) [m], and what it is off the plan as displaced by the feet (2,) [m]."""
        t, omega = tick.t, divergence_rate(tick)
        com, velocity, _, _ = self._reference.balance(t)
        xi = (
            tick.com[:2]
            + tick.com_velocity[:2] / omega
            + omega * tick.momentum_excess_per_weight(self._reference.angular_momentum(t))
        )
        moved = Displacement.of(
            [
                (self.home(contact.point, t), tick.frame(contact.point).position[:2], contact.load)
                for contact in tick.contacts
                if contact.mode == "fixed"
                and contact.load > 0.0
                and contact.point in self._robot.feet
                and not contact.is_rolling
            ]
        )
        return xi, xi - moved.displaced_place(com[:2]) - moved.displaced_rate(velocity[:2]) / omega

    def dcm_at_landing(self, tick: Tick, beside: str, span: float, calm: float) -> tuple[Array, Array]:
        """ξ (2,) after a time [s] if one foot alone does what it can, and what it is off its plan then (2,) [m].

        Where it is off it by less than `calm` now [m], the plan leads it back.
        """
        _, off = self.dcm_and_deviation(tick)
        shift, omega = self.displacement(tick, beside), divergence_rate(tick)
        com, velocity, _, _ = self._reference.balance(tick.t + span)
        planned = com[:2] + velocity[:2] / omega + shift
        if np.linalg.norm(off) < calm:
            return planned, np.zeros(2)
        growth = float(np.exp(omega * span))
        z = self._reference.balance(tick.t)[3] + shift
        sole = self.support(tick, [beside]).inset(ZMP_MARGIN)
        moved = sole.nearest_point(z + off / (1.0 - 1.0 / growth)) - z
        missing = moved + (off - moved) * growth
        return planned + missing, missing

    def displacement(self, tick: Tick, foot: str) -> Array:
        """What a foot that stands is off its planned place (2,) [m]."""
        return tick.frame(foot).position[:2] - self.home(foot, tick.t)

    def home(self, foot: str, t: float) -> Array:
        """Planned place (2,) of a foot that stands at a time [s], or stood or will stand [m]."""
        return (self.early[foot] if foot in self.early else self._planned_places[foot](t))[:2]

    def margin(self, tick: Tick, xi: Array, foot: str, beside: str, place: Array) -> float:
        """Distance of ξ from the edges of the support of a foot that stands and one that has landed at a place [m]."""
        landed = self.sole_corners(tick, foot) - tick.frame(foot).position[:2] + place
        return float(Polygon.hull(np.vstack([self.sole_corners(tick, beside), landed])).margin(xi))

    def planned_place(self, tick: Tick, foot: str, beside: str) -> Array:
        """Planned place (2,) of a foot relative to where the other one stands [m]."""
        return tick.frame(beside).position[:2] + self.home(foot, tick.t) - self.home(beside, tick.t)

    def reachable_place(self, tick: Tick, place: Array, foot: str, beside: str, planned: Array | None = None) -> Array:
        """The nearest place (2,) that a leg reaches without coming near the foot that stands [m].

        planned: a place (2,) that the plan, which knows how feet are turned, has chosen [m]: what is no nearer to that
            foot and no farther than it is in reach, too.
        """
        frame, swings = tick.frame(beside), tick.frame(foot)
        outward = (frame.rotation @ self._left[beside])[:2] * (1.0 if foot == self._robot.feet[0] else -1.0)
        inner = max((self.sole_corners(tick, beside) - frame.position[:2]) @ outward)
        inner -= min((self.sole_corners(tick, foot) - swings.position[:2]) @ outward)
        reach, least, off = (
            self.reach.max_stride,
            inner + SOLE_CLEARANCE * self.reach.leg_length,
            place - frame.position[:2],
        )
        hip = max(least, self.reach.hip_width) * outward
        if planned is not None:
            chosen = planned - frame.position[:2]
            least, reach = min(least, chosen @ outward), max(reach, float(np.linalg.norm(chosen - hip)))
        off = off + max(0.0, least - off @ outward) * outward
        return frame.position[:2] + hip + (off - hip) * (reach / max(reach, float(np.linalg.norm(off - hip))))

    def support(self, tick: Tick, feet: Iterable[str]) -> Polygon:
        """The support of some feet where they are."""
        return Polygon.hull(np.vstack([self.sole_corners(tick, foot) for foot in feet]))

    def sole_corners(self, tick: Tick, foot: str) -> Array:
        """Corners of a foot's sole (nc, 2)."""
        return tick.frame(foot).floor_projection(self._robot.sole(foot))


def predicted_dcm(tick: Tick, xi: Array, support: Polygon, span: float) -> Array:
    """ξ (2,) after a time [s], if the zero-moment point in the support does what it can [m]."""
    z = support.inset(ZMP_MARGIN).nearest_point(xi)
    return z + (xi - z) * np.exp(divergence_rate(tick) * span)
