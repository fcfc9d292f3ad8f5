"""A stack on a state of its own that is pushed when its robot is, so that its schedule catches both by a step."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.control.contact import Contact
from sot.control.controller import Controller
from sot.gravity import GRAVITY
from sot.motion.trajectory import Motion, MotionSample
from sot.polygon import Polygon
from sot.robots.size import leg_length
from sot.servo.stacks.integrated_stack import IntegratedStack

Array = np.ndarray

FOLLOWING_RATE = 3.0
"""Rate at which the divergent component of the own state follows the measured one during a step, in √(g / l)."""

FLOOR_RATE = 14.0
"""Rate at which feet of the own state come to where the floor holds them, in √(g / l): no floor stops them there."""
CALM_DCM_ERROR = 0.0125
"""Distance of the measured divergent component from the own one within which it is followed no longer [legs]."""


class CatchingStack(IntegratedStack):
    """An `IntegratedStack` whose state is pushed along with the robot, once feet that stay cannot bring it back.

    As long as the measured divergent component ξ = c + ċ/ω is over the support, feet that stay bring it back to that of
    the own state, which does not know. Once it is not, no zero-moment point does. The own state then gets the velocity
    at which its ξ is the measured one. Its schedule (`RecoverySchedule`) finds a pushed robot and steps, as it does
    under torque control, and the own ξ follows the measured one until all feet carry, ξ is over them and both are near.
    A foot has landed when its force sensor says so, and stops at once, as the floor stops the robot's.

    Args:
        controller: of the stack, at the period of the calls, with a schedule that steps.
        motion: that the stack follows.
    """

    def __init__(self, controller: Controller, motion: Motion) -> None:
        super().__init__(controller, motion.q[0], motion.v[0])
        self._robot, self._data = motion.robot, motion.robot.model.createData()
        self._omega = float(np.sqrt(GRAVITY / motion.com[0, 2]))
        self._follows, self._leg = False, leg_length(motion.robot)
        rate = FLOOR_RATE * self._omega
        for contact in controller.stack.contacts:
            contact.stiffness, contact.damping = rate**2, 2.0 * rate

    def stances(self) -> dict[str, tuple[pin.SE3, float]]:
        """Foot -> place of its frame in the own state and load of its contact (0 to 1), of the feet that stand."""
        model, data = self._robot.model, self._data
        pin.forwardKinematics(model, data, self._q)
        return {
            contact.point: (
                pin.updateFramePlacement(model, data, self._robot.point(contact.point)).copy(),
                contact.load,
            )
            for contact in self._standing()
        }

    def divergent_component(self) -> Array:
        """ξ of the own state (2,) [m]."""
        com = pin.centerOfMass(self._robot.model, self._data, self._q, self._v)
        own: Array = (com + self._data.vcom[0] / self._omega)[:2]
        return own

    def sample_for(self, t: float, dcm: Array, loads: Mapping[str, float]) -> MotionSample:
        """State at a time [s], pushed if the robot has to be caught.

        Args:
            t: time [s].
            dcm: measured ξ (2,), as seen from the feet that stand in the own state [m].
            loads: measured normal forces of the feet [N].
        """
        followed, self._follows = self._follows, self._has_to_follow(dcm)
        if self._follows:
            share = FOLLOWING_RATE * self._omega * self._controller.tick.period if followed else 1.0
            self._push(share * self._omega * (dcm - self.divergent_component()))
        return self.sample(t, loads)

    def sample(self, t: float, loads: Mapping[str, float] | None = None) -> MotionSample:
        """As that of `IntegratedStack`; the floor stops a foot that lands, as it does under the robot."""
        stood = self._standing()
        sample = super().sample(t, loads)
        landed = [contact for contact in self._standing() if contact not in stood]
        if landed:
            self._push(np.zeros(2))
            for contact in landed:
                contact.arrival_acceleration = None
        return sample

    def _standing(self) -> list[Contact]:
        feet = self._robot.feet
        return [one for one in self._controller.stack.contacts if one.point in feet and one.mode == "fixed"]

    def _has_to_follow(self, dcm: Array) -> bool:
        """Whether the own state follows ξ (2,): from when it leaves the support of all feet until it is over them, near
        its own."""
        stances, feet = self.stances(), self._robot.feet
        if len(stances) < len(feet) or any(load < 1.0 for _, load in stances.values()):
            return self._follows
        corners = [place.act(corner)[:2] for foot, (place, _) in stances.items() for corner in self._robot.sole(foot)]
        if self._follows and np.linalg.norm(dcm - self.divergent_component()) > CALM_DCM_ERROR * self._leg:
            return True
        return float(Polygon.hull(np.array(corners)).margin(dcm)) < 0.0

    def _push(self, change: Array) -> None:
        """Change the horizontal velocity of the centre of mass (2,) [m/s] by the least kinetic energy; feet stop."""
        model, data, q = self._robot.model, self._data, self._q
        mass = np.triu(pin.crba(model, data, q))
        mass += np.triu(mass, 1).T
        rows = [pin.jacobianCenterOfMass(model, data, q)[:2].copy()]
        for contact in self._standing():
            frame = self._robot.point(contact.point)
            rows.append(pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED))
        J = np.vstack(rows)
        wanted = -J @ self._v
        wanted[:2] = change
        effect = np.linalg.solve(mass, J.T)
        self._v = self._v + effect @ np.linalg.lstsq(J @ effect, wanted, rcond=None)[0]
