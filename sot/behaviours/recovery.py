"""Steps that catch a disturbed robot: unplanned ones, and planned ones that land elsewhere."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sot.behaviours.capture import Capture, predicted_dcm
from sot.behaviours.planned_swing import EarlyLanding, LedSwing, PlannedSwing
from sot.behaviours.stepping import SteppingSchedule
from sot.behaviours.stride import Stride
from sot.behaviours.support_height import support_height
from sot.control.pose import PoseReference
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.motion.feet.contacts import Phase
from sot.motion.feet.footfalls import Footfalls
from sot.motion.trajectory import Motion, Reference
from sot.polygon import Polygon
from sot.robots.robot import Robot

Array = np.ndarray

DISTURBED_DCM_ERROR, CALM_DCM_ERROR = 0.05, 0.025
"""Distance of the divergent component from its plan beyond which it is disturbed, within which it is calm [legs]."""
MIN_SWING_TIME, RETURN_SWING_TIME = 1.01, 1.21
"""Shortest swing that catches the robot, and the swing back to the planned place [√(leg / g)]."""
MIN_TIME_BETWEEN_STEPS = 1.21
"""Least time between two steps, unless balance needs the second one [√(leg / g)]."""
FOOTHOLD_FREEZE_TIME = 0.323
"""Time before touchdown from which on the foothold stays [√(leg / g)]."""
STEP_HEIGHT = 0.083
"""Height of an unplanned step [legs]."""
DCM_MARGIN_AFTER_STEP = 0.067
"""Distance from the support's edges that the divergent component should have after a step [legs]."""
MIN_LANDING_TIME, LANDINGS_TRIED = 0.606, 6
"""Least time in which a foot in the air gets to the floor [√(leg / g)], and how many times up to the planned one are
tried."""
CHECK_INTERVAL = 0.01
"""Interval between two checks whether a step is needed [s]."""
FOOTHOLD_ITERATIONS = 5
"""Iterations that find a foothold."""
MIN_MARGIN_GAIN = 0.017
"""Least gain of a step over none, in the distance of the divergent component from the support's edges [legs]."""
HOME_DISTANCE = 0.033
"""Distance from its planned place within which a foot stays where it is [legs]."""
ASTRAY_DISTANCE = 0.15
"""Distance of a foot from its planned place beside the other one beyond which planned steps lead astray [legs]."""
HOMEWARD_LENGTH = 0.05
"""Length by which a planned step leads back, of what the foot beside it is off its place [legs]: it disturbs nobody."""
MIN_REDIRECTION = 0.0067
"""Change of where a planned swing is to land for which it is led elsewhere [legs]."""


@dataclass(slots=True)
class _Step:
    """A needed or running step: the foot and the one that stands, start and landing place [m], swing time [s], and the
    height of the ground [m]."""

    foot: str
    beside: str
    start: Array
    rotation: Array
    place: Array
    swing_time: float
    stances_before: int
    ground: float
    trajectory: Stride | None = None


class RecoverySchedule(SteppingSchedule):
    """Leads contacts as `SteppingSchedule` does, and lets a foot step where balance needs it; it steps back later.

    Of the centre of mass only ξ = c + ċ/ω diverges, ξ̇ = ω (ξ − z), ω² = g / c_z. The angular momentum ΔL that the plan
    has not has to go as well, and takes as much of the support as if ξ were at

        ξ + ω / (m g) (ΔL_y, −ΔL_x).

    Once that is off its plan and out of what both feet support, no zero-moment point z leads back. Then the foot steps
    that brings it deepest into the new support, to the place nearest to its planned one that leaves

        ξ(T) = z + (ξ − z) exp(ω T),   z the nearest that the other foot can hold,

    some room; while it swings the place follows ξ. A step that leads no farther in than none is not made, nor one for
    which the plan leaves no time.

    While a step of the plan swings, its foot lands off its place by what ξ will be off the plan by then,

        δ(T) = δz + (δ − δz) exp(ω T),   δz the nearest to δ / (1 − exp(−ω T)) that the other foot can hold.

    The plan then goes on from there, and comes back by a little with each further step. Where no such place leaves ξ
    in the support of both feet, the foot lands as early as brings it deepest into it.

    The stack needs `tasks.SwingFoot` for both feet.

    Args:
        robot: The robot.
        reference: What it does.
        phases: Which feet stand where meanwhile, as far as it is known.
        swings: Foot -> its path from one foothold to the next, where its contact is off.
        ramp, heel_paths: As for `SteppingSchedule`.
    """

    def __init__(
        self,
        robot: Robot,
        reference: Reference,
        phases: Sequence[Phase],
        swings: Mapping[str, PoseReference],
        ramp: float = 0.04,
        heel_paths: Mapping[str, PoseReference] | None = None,
    ) -> None:
        super().__init__(robot, phases, ramp, heel_paths)
        self._robot, self._swings, self._capture = robot, swings, Capture(robot, reference)
        self._leg = self._capture.reach.leg_length
        self._time = float(np.sqrt(self._leg / GRAVITY))
        self._min_swing_time, self._return_time = MIN_SWING_TIME * self._time, RETURN_SWING_TIME * self._time
        self._step: _Step | None = None
        self._rest_until = np.inf  # until when no foot goes back to its place: for ever, unless one has left it
        self._checked_at = -np.inf
        self._free_feet: list[tuple[str, str]] = []  # feet that another one lets go, with that one
        self._led: dict[str, LedSwing | EarlyLanding] = {}  # planned swings that land elsewhere
        self._seen: set[str] = set()  # feet that swing by the plan since an earlier check

    @classmethod
    def of(cls, motion: Motion) -> "RecoverySchedule":
        """The schedule of a motion."""
        paths = {foot: PlannedSwing(Footfalls(motion.phases, foot), motion.pose(foot)) for foot in motion.robot.feet}
        heels = {foot: motion.pose(foot) for foot in {foot for phase in motion.phases for foot in phase.rising}}
        return cls(motion.robot, motion, motion.phases, paths, heel_paths=heels)

    def observe(self, tick: Tick) -> None:
        """Check whether a step is needed, or update the foothold of the running one."""
        step = self._step
        if step is None or step.trajectory is None:
            if not 0.0 < tick.t - self._checked_at < CHECK_INTERVAL:
                self._checked_at, self._step = tick.t, self._needed_step(tick) if self._all_feet_carry(tick) else None
                self._lead_planned_swings(tick)
        elif tick.t < step.trajectory.land - FOOTHOLD_FREEZE_TIME * self._time:
            xi, _ = self._capture.dcm_and_deviation(tick)
            step.trajectory.redirect(
                tick.t, self._foothold_and_margin(tick, xi, step.foot, step.beside, step.trajectory.land - tick.t)[0]
            )

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """As `SteppingSchedule`, and let a foot begin the step that is needed."""
        step, begun = self._step, []
        if step is not None and step.trajectory is None:
            lift, land = t + self.ramp, t + self.ramp + step.swing_time
            step.trajectory = stack.contact(step.foot).path = Stride(
                step.start, step.rotation, lift, land, STEP_HEIGHT * self._leg, step.ground
            )
            step.trajectory.redirect(lift, step.place)
            stack.contact(step.foot).is_catching = True
            self.add_step(step.foot, lift, land)
            begun = [f"{step.foot} steps"]
        if not 0.0 < t - self._checked_at < CHECK_INTERVAL - 1e-9:
            pairs = self._robot.feet, self._robot.feet[::-1]
            self._free_feet = [pair for pair in pairs if self.others_carry(pair[0], stack, loads)]
        for foot, swing in self._led.items():
            stack.contact(foot).path = swing
        done = begun + super().apply(t, stack, loads)
        for foot in self._robot.feet:
            contact = stack.contact(foot)
            if contact.mode == "fixed" and foot in self._led:
                led, contact.path = self._led.pop(foot), None
                if isinstance(led, EarlyLanding):
                    self._capture.early[foot] = contact.foothold = led.planned
            elif contact.mode == "off" and foot in self._capture.early:
                del self._capture.early[foot]
                contact.foothold = None
        if step is not None and self.stances_begun(step.foot) > step.stances_before:
            stack.contact(step.foot).path = self._step = None
            stack.contact(step.foot).is_catching = False
            self._rest_until = t + MIN_TIME_BETWEEN_STEPS * self._time
        return done

    def is_disturbed(self, tick: Tick, was: bool = False) -> bool:
        """Whether the divergent component is farther off its plan than tracking has it, or a foot that stands off its
        place beside the other one; if it was so, until it is calm."""
        capture, feet = self._capture, self._robot.feet
        _, off = capture.dcm_and_deviation(tick)
        if np.linalg.norm(off) > (CALM_DCM_ERROR if was else DISTURBED_DCM_ERROR) * self._leg:
            return True
        if any(contact.mode != "fixed" for contact in tick.contacts if contact.point in feet):
            return False
        astray = capture.planned_place(tick, *feet) - tick.frame(feet[0]).position[:2]
        return bool(np.linalg.norm(astray) > ASTRAY_DISTANCE * self._leg)

    def _all_feet_carry(self, tick: Tick) -> bool:
        """Whether all feet stand with all their load, and by the plan for long enough for a step."""
        stand = all(contact.mode == "fixed" and contact.load >= 1.0 for contact in tick.contacts)
        rest = MIN_TIME_BETWEEN_STEPS * self._time
        return stand and self.next_lift() > tick.t + self.ramp + self._return_time + rest

    def _lead_planned_swings(self, tick: Tick) -> None:
        """Lead the foot that swings by the plan, if the robot is disturbed or does not stand where it should."""
        swinging = {contact.point for contact in tick.contacts if contact.mode == "off"}
        swinging &= {foot for foot in self._robot.feet if self.stances_to_come(foot) and self.stances_begun(foot)}
        for foot, beside in (self._robot.feet, self._robot.feet[::-1]):
            if foot in swinging and beside not in swinging:
                self._lead_planned_swing(tick, foot, beside)
        self._seen = swinging

    def _lead_planned_swing(self, tick: Tick, foot: str, beside: str) -> None:
        land = self.next_landing(foot)
        span = land - tick.t
        if span < FOOTHOLD_FREEZE_TIME * self._time:
            return
        led, path = self._led.get(foot), self._swings[foot]
        planned = led.planned if led else path(land).position
        displaced = self._capture.displacement(tick, beside)
        back = HOMEWARD_LENGTH * self._leg
        home = displaced * max(0.0, 1.0 - back / max(float(np.linalg.norm(displaced)), back))
        calm = (CALM_DCM_ERROR if led else DISTURBED_DCM_ERROR) * self._leg
        xi, missing = self._capture.dcm_at_landing(tick, beside, span + self.ramp, calm)
        if led is None:
            at = tick.frame(foot).position[:2]
            start = np.zeros(2) if foot in self._seen else at - path(tick.t).position[:2]
            if max(np.linalg.norm(start), np.linalg.norm(home), np.linalg.norm(missing)) < HOME_DISTANCE * self._leg:
                return
            led = self._led[foot] = LedSwing(path, tick.t, land, start)
        place = self._capture.reachable_place(tick, planned[:2] + home + missing, foot, beside, planned[:2] + displaced)
        if isinstance(led, LedSwing) and missing.any():
            depth = self._capture.margin(tick, xi, foot, beside, place)
            if depth < 0.0 and (best := self._deeper_landing(tick, foot, beside, home, depth)):
                early, place = best
                self.move_landing(foot, early)
                self._led[foot] = EarlyLanding(tick.t, led(tick.t), early, path(land), place - planned[:2])
                return
        way = place - planned[:2] - led.landing_off
        length, most = float(np.linalg.norm(way)), self._capture.reach.light_swing_length(span)
        if length > MIN_REDIRECTION * self._leg:
            led.redirect(tick.t, led.landing_off + way * min(1.0, most / length))

    def _deeper_landing(
        self, tick: Tick, foot: str, beside: str, home: Array, depth: float
    ) -> tuple[float, Array] | None:
        """Time [s] and place (2,) of an earlier landing that has ξ deepest in the support of both feet, if any has."""
        led, best, land = self._led[foot], None, self.next_landing(foot)
        at, deepest = led(tick.t).position, depth + MIN_MARGIN_GAIN * self._leg
        for early in np.linspace(tick.t + MIN_LANDING_TIME * self._time, land, LANDINGS_TRIED, endpoint=False):
            span = float(early - tick.t)
            xi, missing = self._capture.dcm_at_landing(tick, beside, span + self.ramp, 0.0)
            place = self._capture.reachable_place(tick, led.planned[:2] + home + missing, foot, beside)
            way = float(np.linalg.norm(np.append(place, led.planned[2]) - at))
            depth = self._capture.margin(tick, xi, foot, beside, place)
            if depth > deepest and way <= self._capture.reach.light_swing_length(span):
                deepest, best = depth, (float(early), place)
        return best

    def _needed_step(self, tick: Tick) -> _Step | None:
        """The step that the robot needs now, or the way back that it may take; None in an undisturbed dance."""
        xi, deviation = self._capture.dcm_and_deviation(tick)
        off = float(np.linalg.norm(deviation)) / self._leg
        if off < DISTURBED_DCM_ERROR:
            return self._return_step(tick, xi) if off < CALM_DCM_ERROR and tick.t > self._rest_until else None
        support = self._capture.support(tick, self._robot.feet)
        if support.margin(xi) >= 0.0:
            return None
        step, later = None, predicted_dcm(tick, xi, support, self._min_swing_time + 2.0 * self.ramp)
        best = float(support.margin(later)) + MIN_MARGIN_GAIN * self._leg
        for foot, beside in self._free_feet:
            place, depth = self._foothold_and_margin(tick, xi, foot, beside, self.ramp + self._min_swing_time)
            span = max(
                self._min_swing_time,
                float(np.linalg.norm(place - tick.frame(foot).position[:2])) / self._capture.reach.swing_speed,
            )
            if span > self._min_swing_time:
                place, depth = self._foothold_and_margin(tick, xi, foot, beside, self.ramp + span)
            if depth > best:
                best, step = depth, self._new_step(tick, foot, beside, place, span)
        return step

    def _return_step(self, tick: Tick, xi: Array) -> _Step | None:
        """A step that brings a foot back to its planned place, if ξ allows it."""
        for foot, beside in self._free_feet:
            home = self._capture.planned_place(tick, foot, beside)
            if np.linalg.norm(home - tick.frame(foot).position[:2]) > HOME_DISTANCE * self._leg:
                place, _ = self._foothold_and_margin(tick, xi, foot, beside, self.ramp + self._return_time)
                if np.array_equal(place, home):
                    return self._new_step(tick, foot, beside, place, self._return_time)
        return None

    def _new_step(self, tick: Tick, foot: str, beside: str, place: Array, span: float) -> _Step:
        frame = tick.frame(foot)
        begun, ground = self.stances_begun(foot), support_height(tick)
        return _Step(foot, beside, frame.position.copy(), frame.rotation.copy(), place, span, begun, ground)

    def _foothold_and_margin(self, tick: Tick, xi: Array, foot: str, beside: str, span: float) -> tuple[Array, float]:
        """Foothold (2,) after a time [s], and the distance of ξ from the new support's edges once it carries [m]."""
        stands, sole = (
            self._capture.sole_corners(tick, beside),
            self._capture.sole_corners(tick, foot) - tick.frame(foot).position[:2],
        )
        xi = predicted_dcm(tick, xi, Polygon.hull(stands), span + self.ramp)
        place = self._capture.planned_place(tick, foot, beside)
        for _ in range(FOOTHOLD_ITERATIONS):
            # The support's edge between both feet moves by a part of what one of them does.
            support = Polygon.hull(np.vstack([stands, place + sole])).inset(DCM_MARGIN_AFTER_STEP * self._leg)
            missing = xi - support.nearest_point(xi)
            if not missing.any():
                break
            place = self._capture.reachable_place(tick, place + missing, foot, beside)
        return place, self._capture.margin(tick, xi, foot, beside, place)
