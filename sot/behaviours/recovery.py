"""Steps that nobody planned: made when what disturbs the robot takes its balance out of the reach of its feet."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.behaviours.displacement import Displacement
from sot.behaviours.stepping import Stepping
from sot.behaviours.stride import Stride
from sot.control.stack import Stack
from sot.control.tick import GRAVITY, Tick
from sot.motion.feet.footholds import CLEARANCE, Reach
from sot.motion.trajectory import Motion
from sot.polygon import Polygon
from sot.robots.robot import Robot

Array = np.ndarray

DISTURBED, CALM = 0.03, 0.015
"""Distance of the divergent component from its plan [m] beyond which it is disturbed, and within which it is not."""
QUICK, GENTLE = 0.25, 0.3
"""Shortest time that a foot is in the air, to catch the robot and to go back to its planned place [s]."""
REST = 0.3
"""Time between two steps, unless the second one is needed [s]."""
SETTLED = 0.08
"""Time before it lands from which on a foot's place is not changed any more [s]."""
HEIGHT = 0.05
"""Of a step [m]."""
EDGE = 0.01
"""Distance from the edges of a support within which the zero-moment point can be kept [m]."""
ROOM = 0.04
"""Distance from the edges of the support after a step that the divergent component is to have [m]."""
LOOK = 0.01
"""Interval at which it is looked whether a step is needed [s]."""
ROUNDS = 5
"""In which a foot's place is found."""
GAIN = 0.01
"""What a step has to be better than none, at least [m]."""
HOME = 0.02
"""Distance from its planned place within which a foot is left where it is [m]."""


@dataclass(slots=True)
class _Step:
    """A step to be made, or on its way: with which foot beside which, from where to where, how long it takes [s]."""

    foot: str
    beside: str
    start: Array
    rotation: Array
    place: Array
    span: float
    stances: int
    way: Stride | None = None


class Recovery(Stepping):
    """Leads contacts as `Stepping` does, and lets a foot step where balance needs it; the foot goes back when it can.

    Of the centre of mass only ξ = c + ċ/ω diverges, ξ̇ = ω (ξ − z), ω² = g / c_z. The angular momentum ΔL that the plan
    has not has to go as well, and takes as much of the support as if ξ were at

        ξ + ω / (m g) (ΔL_y, −ΔL_x).

    Once that is off its plan and out of what both feet support, no zero-moment point z leads back. Then the foot steps
    that brings it deepest into the new support, to the place nearest to its planned one that leaves

        ξ(T) = z + (ξ − z) exp(ω T),   z the nearest that the other foot can hold,

    some room; while it swings the place follows ξ. A step that leads no farther in than none is not made. The feet
    are meant to stand by the plan: it makes no such steps before the last of its own.

    The stack needs `tasks.SwingFoot` for both feet.

    Args:
        robot: The robot.
        motion: What it does.
        ramp: As for `Stepping`.
    """

    def __init__(self, robot: Robot, motion: Motion, ramp: float = 0.04) -> None:
        super().__init__(robot, motion.phases, ramp)
        self._robot, self._motion, self._places = robot, motion, motion.feet
        self._reach = Reach.of(robot)
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        # What points to the robot's left, seen from its feet.
        self._left = {foot: data.oMf[robot.point(foot)].rotation.T @ (0.0, 1.0, 0.0) for foot in robot.feet}
        self._step: _Step | None = None
        self._rested = np.inf  # until when no foot goes back to its place: for ever, unless one has left it
        self._looked = -np.inf
        self._free: list[tuple[str, str]] = []  # feet that another one lets go, with that one

    def observe(self, tick: Tick) -> None:
        """See whether a step is needed, or where the one that is on its way is to land."""
        step = self._step
        if step is None or step.way is None:
            if not 0.0 < tick.t - self._looked < LOOK:
                self._looked, self._step = tick.t, self._needed(tick) if self._ready(tick) else None
        elif tick.t < step.way.land - SETTLED:
            xi, _ = self._divergent(tick)
            step.way.lead(tick.t, self._foothold(tick, xi, step.foot, step.beside, step.way.land - tick.t)[0])

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """As `Stepping`, and let a foot begin the step that is needed."""
        step, begun = self._step, []
        if step is not None and step.way is None:
            lift, land = t + self.ramp, t + self.ramp + step.span
            step.way = stack.contact(step.foot).path = Stride(step.start, step.rotation, lift, land, HEIGHT)
            step.way.lead(lift, step.place)
            self.interrupt(step.foot, lift, land)
            begun = [f"{step.foot} steps"]
        if not 0.0 < t - self._looked < LOOK - 1e-9:
            pairs = self._robot.feet, self._robot.feet[::-1]
            self._free = [pair for pair in pairs if self.others_carry(pair[0], stack, loads)]
        done = begun + super().apply(t, stack, loads)
        if step is not None and self.begun(step.foot) > step.stances:
            stack.contact(step.foot).path = self._step = None
            self._rested = t + REST
        return done

    def _ready(self, tick: Tick) -> bool:
        """Whether all feet stand with all their load, for good by the plan."""
        stand = all(contact.mode == "fixed" and contact.load >= 1.0 for contact in tick.contacts)
        return stand and not any(self.due(foot) for foot in self._robot.feet)

    def _needed(self, tick: Tick) -> _Step | None:
        """The step that the robot needs now, or may make; none in an undisturbed dance."""
        xi, off = self._divergent(tick)
        if off < DISTURBED:
            return self._return(tick, xi) if off < CALM and tick.t > self._rested else None
        support = Polygon.hull(np.vstack([self._sole(tick, foot) for foot in self._robot.feet]))
        if support.margin(xi) >= 0.0:
            return None
        best, step = GAIN + float(support.margin(_ahead(tick, xi, support, QUICK + 2.0 * self.ramp))), None
        for foot, beside in self._free:
            place, depth = self._foothold(tick, xi, foot, beside, self.ramp + QUICK)
            span = max(QUICK, float(np.linalg.norm(place - tick.frame(foot).position[:2])) / self._reach.speed)
            if span > QUICK:
                place, depth = self._foothold(tick, xi, foot, beside, self.ramp + span)
            if depth > best:
                best, step = depth, self._stepping(tick, foot, beside, place, span)
        return step

    def _return(self, tick: Tick, xi: Array) -> _Step | None:
        """A step that brings a foot back to where the plan has it, if ξ lets it."""
        for foot, beside in self._free:
            home = self._home(tick, foot, beside)
            if np.linalg.norm(home - tick.frame(foot).position[:2]) > HOME:
                place, _ = self._foothold(tick, xi, foot, beside, self.ramp + GENTLE)
                if np.array_equal(place, home):
                    return self._stepping(tick, foot, beside, place, GENTLE)
        return None

    def _stepping(self, tick: Tick, foot: str, beside: str, place: Array, span: float) -> _Step:
        frame = tick.frame(foot)
        return _Step(foot, beside, frame.position.copy(), frame.rotation.copy(), place, span, self.begun(foot))

    def _divergent(self, tick: Tick) -> tuple[Array, float]:
        """ξ with angular momentum (2,), and its distance from the plan, as the feet stand [m]."""
        t, omega = tick.t, _rate(tick)
        com, velocity, _, _ = self._motion.balance(t)
        xi = (
            tick.com[:2]
            + tick.com_velocity[:2] / omega
            + omega * tick.momentum_excess_per_weight(self._motion.angular_momentum(t))
        )
        moved = Displacement.of(
            [(self._places[foot](t)[:2], tick.frame(foot).position[:2], 1.0) for foot in self._robot.feet]
        )
        return xi, float(np.linalg.norm(xi - moved.place(com[:2]) - moved.rate(velocity[:2]) / omega))

    def _home(self, tick: Tick, foot: str, beside: str) -> Array:
        """The place (2,) that the plan has for a foot beside where the other one stands."""
        return tick.frame(beside).position[:2] + (self._places[foot](tick.t) - self._places[beside](tick.t))[:2]

    def _foothold(self, tick: Tick, xi: Array, foot: str, beside: str, span: float) -> tuple[Array, float]:
        """Where a foot lands some time from now [s], (2,), and how deep in the support ξ is once it carries [m]."""
        stands, sole = self._sole(tick, beside), self._sole(tick, foot) - tick.frame(foot).position[:2]
        xi = _ahead(tick, xi, Polygon.hull(stands), span + self.ramp)
        place = self._home(tick, foot, beside)
        for _ in range(ROUNDS):
            # The support's edge between both feet moves by a part of what one of them does.
            missing = xi - Polygon.hull(np.vstack([stands, place + sole])).inset(ROOM).nearest_point(xi)
            if not missing.any():
                break
            place = self._within(tick, place + missing, foot, beside)
        return place, float(Polygon.hull(np.vstack([stands, place + sole])).margin(xi))

    def _within(self, tick: Tick, place: Array, foot: str, beside: str) -> Array:
        """The nearest place that a leg reaches without coming near the foot that stands, (2,)."""
        frame, swings = tick.frame(beside), tick.frame(foot)
        outward = (frame.rotation @ self._left[beside])[:2] * (1.0 if foot == self._robot.feet[0] else -1.0)
        inner = max((self._sole(tick, beside) - frame.position[:2]) @ outward)
        inner -= min((self._sole(tick, foot) - swings.position[:2]) @ outward)
        reach, least, off = self._reach.stride, inner + CLEARANCE, place - frame.position[:2]
        off = off + max(0.0, least - off @ outward) * outward
        hip = max(least, self._reach.hips) * outward
        return frame.position[:2] + hip + (off - hip) * (reach / max(reach, float(np.linalg.norm(off - hip))))

    def _sole(self, tick: Tick, foot: str) -> Array:
        """Corners of a foot's sole (nc, 2)."""
        return tick.frame(foot).floor_projection(self._robot.sole(foot))


def _rate(tick: Tick) -> float:
    """ω, at which ξ diverges [1/s]."""
    return float(np.sqrt(GRAVITY / max(tick.com[2], 0.1)))


def _ahead(tick: Tick, xi: Array, support: Polygon, span: float) -> Array:
    """Where ξ (2,) is some time from now [s] if a support does what it can."""
    z = support.inset(EDGE).nearest_point(xi)
    return z + (xi - z) * np.exp(_rate(tick) * span)
