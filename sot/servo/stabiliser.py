"""The position controller of a dance on compliant feet: a plan, what its loads deflect undone, and feedback."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal, Protocol

import numpy as np
import pinocchio as pin

from sot.gravity import GRAVITY
from sot.hardware.compliance import DEFAULT_LOSS, FootCompliance, bush_position
from sot.hardware.readings import Readings, measured_zmp
from sot.hardware.servo import JointTargets, Servo
from sot.motion.feet.contacts import Phase, phase_at
from sot.motion.trajectory import Motion, MotionSample
from sot.servo.admittance import AdmittanceGains, FootAdmittance
from sot.servo.compliance_estimate import ComplianceEstimate
from sot.servo.load_sharing import ContactLoadSharing, LoadSharing
from sot.servo.posture_correction import PostureCorrection, leg_compliance
from sot.servo.sag import ServoSag, bush_compliance, sag_offset
from sot.servo.stacks.catching_stack import CatchingStack

Array = np.ndarray

DCM_GAIN = 1.15
"""Rate at which the divergent component converges, in √(g / l): 4/s for 0.8 m."""
MIN_SHARE = 1e-3
"""Least weight of a foot that stands where the plan is seen from: of two that come and go at once, each has one."""


class Damping(Protocol):
    """A controller of the sway from the zero-moment point alone."""

    def __call__(self, t: float, zmp: Array) -> Array:
        """Shift (2,) of the centre of mass [m] for the deviation (2,) of the measured zero-moment point [m]."""
        ...


@dataclass(frozen=True, slots=True)
class DcmGains:
    """Gains of the feedback of the divergent component and of the feet that carry it out.

    Attributes:
        convergence: rate at which the component converges, in √(g / l).
        feet: of the admittance.
    """

    convergence: float = DCM_GAIN
    feet: AdmittanceGains = field(default_factory=AdmittanceGains)


class Stabiliser:
    """Joint targets of a motion, with the sag of feet and servos undone, and with one of two feedbacks, or none.

    The divergent component ξ = c + ċ/ω of the measured state asks for the zero-moment point

        z* = z + (1 + k/ω) (ξ − ξ_ref),

    which the feet share; each turns and the legs lengthen until the feet measure that (`FootAdmittance`). Or a damping
    controller shifts the centre of mass by what it makes of the measured zero-moment point, Kim & Oh 4.

    Args:
        motion: the plan.
        period: control period [s].
        compliance: of the feet: what the planned load deflects is undone. "estimated" where it is not known; None for
            rigid feet.
        servo: of the joints: what the planned load deflects is undone in them, too; None for none.
        dcm: gains of the feedback of the divergent component; None for none.
        damping: the damping controller; None for none.
        sample: where the posture comes from, `t -> MotionSample`, called once a tick: an `IntegratedStack`'s; the plan
            itself unless given.
        catching: the stack that leads the robot, and steps where the feet cannot bring the divergent component back;
            in the place of `sample`.
    """

    def __init__(
        self,
        motion: Motion,
        period: float,
        compliance: FootCompliance | Literal["estimated"] | None = None,
        servo: Servo | None = None,
        dcm: DcmGains | None = None,
        damping: Damping | None = None,
        sample: Callable[[float], MotionSample] | None = None,
        catching: CatchingStack | None = None,
    ) -> None:
        robot = motion.robot
        self.period, self._motion = period, motion
        self._sample = catching.sample if catching else sample or motion.sample
        self._data = robot.model.createData()
        self._catching = catching
        self._loads = ContactLoadSharing(motion, catching.stances) if catching else LoadSharing(motion)
        self._correction = PostureCorrection(robot, period)
        self._bushes = {foot: bush_position(robot, foot) for foot in robot.feet}
        length = float(motion.com[0, 2])
        self._omega = np.sqrt(GRAVITY / length)
        self._damping, self._dcm = damping, dcm
        self._compliance = bush_compliance(compliance) if isinstance(compliance, FootCompliance) else np.zeros(3)
        self._estimate = ComplianceEstimate(robot, length, self._bushes) if compliance == "estimated" else None
        self._legs = leg_compliance(robot, servo or Servo.of(robot))
        self._servo_sag = ServoSag(robot, servo) if servo else None
        self._servo_offset: Array | None = None
        known = compliance if isinstance(compliance, FootCompliance) else None
        relaxation = known.relaxation_time(robot) if known else DEFAULT_LOSS / float(self._omega)
        self._admittance = FootAdmittance(robot, length, dcm.feet, relaxation, period) if dcm else None

    def __call__(self, t: float, q: Array, v: Array, readings: Readings) -> JointTargets:
        """One tick, see `PositionController`."""
        robot = self._motion.robot
        measured = any(wrench.any() for wrench in readings.foot_wrench.values())  # nothing is before the first step
        if self._catching is not None and measured:
            forces = {foot: float(wrench[2]) for foot, wrench in readings.foot_wrench.items()}
            plan = self._catching.sample_for(t, self.divergent_component(t, q, v), forces)
        else:
            plan = self._sample(t)
        force = robot.mass * (plan.com_acceleration + np.array([0.0, 0.0, GRAVITY]))
        if self._estimate is not None and measured:
            self._compliance = self._estimate(readings)
        offsets = {foot: np.zeros(3) for foot in robot.feet}
        loads = self._loads(t, plan.zmp, force)
        if self._compliance.any():
            for foot, load in loads.items():
                offsets[foot] = sag_offset(load, self._compliance, self._bushes[foot])
        if self._dcm is not None and self._admittance is not None and measured:
            off = self.divergent_component(t, q, v) - (plan.com + plan.com_velocity / self._omega)[:2]
            wanted = self._loads(t, plan.zmp + (1.0 + self._dcm.convergence) * off, force)
            compliance = {foot: own + self._compliance for foot, own in self._legs.items()}
            for foot, offset in self._admittance(wanted, readings.foot_wrench, compliance).items():
                offsets[foot] += offset
        shift = np.zeros(2)
        if self._damping is not None and measured:
            feet = self._loads.feet(t)
            shift = self._damping(t, measured_zmp({foot: readings.foot_wrench[foot] for foot in feet}, feet) - plan.zmp)
        targets = self._correction(plan.q, plan.v, shift, offsets)
        return targets if self._servo_sag is None else self._with_torques(targets, self._servo_sag(plan, loads))

    def phase(self, t: float) -> Phase:
        """The feet that stand at a time [s], and where: as planned, or as steps that catch the robot have them now."""
        planned = phase_at(self._motion.phases, t)
        if self._catching is None:
            return planned
        return replace(planned, feet={foot: place for foot, (place, _) in self._catching.stances().items()})

    def _with_torques(self, targets: JointTargets, offset: Array) -> JointTargets:
        """Targets at which servos that give the planned torques are where they were to be."""
        before, self._servo_offset = self._servo_offset, offset
        rate = (offset - before) / self.period if before is not None else np.zeros_like(offset)
        return JointTargets(targets.position + offset, targets.velocity + rate)

    def divergent_component(self, t: float, q: Array, v: Array) -> Array:
        """ξ of a state (2,), moved and turned along with the feet that stand flat from where they are to their plan."""
        robot, data = self._motion.robot, self._data
        pin.centerOfMass(robot.model, data, q, v, False)
        xi = (data.com[0] + data.vcom[0] / self._omega)[:2]
        feet, limits = self._loads.flat_feet(t), self._loads.limits(t)
        seen, total = np.zeros(2), 0.0
        for foot, planned in feet.items():
            place, share = pin.updateFramePlacement(robot.model, data, robot.point(foot)), max(limits[foot], MIN_SHARE)
            turn = planned.rotation @ place.rotation.T
            c, s = turn[0, 0] + turn[1, 1], turn[1, 0] - turn[0, 1]
            turned = np.array([[c, -s], [s, c]]) @ (xi - place.translation[:2]) / np.hypot(c, s)
            seen, total = seen + share * (planned.translation[:2] + turned), total + share
        return seen / total if feet else xi
