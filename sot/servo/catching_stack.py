"""A stack on a state of its own that is pushed when its robot is, so that its schedule catches both by a step."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.control.controller import Controller
from sot.gravity import GRAVITY
from sot.motion.trajectory import MotionSample
from sot.polygon import Polygon
from sot.servo.integrated_stack import IntegratedStack

Array = np.ndarray

OBSERVER_RATE = 3.0
"""Rate at which the divergent component of the stack's own state follows the measured one while it has to be caught, in
√(g / l): …"""
FIRST_SHARE = 1.0
"""… and the share of their difference that it takes over at once when that begins."""


class CatchingStack(IntegratedStack):
    """An `IntegratedStack` whose state is pushed along with the robot, once feet that stay cannot bring it back.

    As long as the measured divergent component ξ = c + ċ/ω is over the support, the feet bring it back to that of the
    stack's own state, and the stack does not know. Once it is not, no zero-moment point does. The own state then gets
    the velocity at which its ξ is the measured one: the change of least kinetic energy under which its contacts stay.
    Its schedule (`RecoverySchedule`) sees a pushed robot and steps, as it does under torque control. While a foot is in
    the air, the own ξ follows the measured one; a foot lands when its force sensor says so.

    Args:
        controller: of the stack, at the period of the calls, with a schedule that steps.
        q, v: state to begin with (nq,), (nv,).
    """

    def __init__(self, controller: Controller, q: Array, v: Array) -> None:
        super().__init__(controller, q, v)
        system = controller.system
        self._robot, self._data = system.robot, system.robot.model.createData()
        self._omega = float(np.sqrt(GRAVITY / pin.centerOfMass(self._robot.model, self._data, q)[2]))
        self._follows = False

    def stances(self) -> dict[str, tuple[pin.SE3, float]]:
        """Foot -> place of its frame in the own state and load (0 to 1), of the feet that stand."""
        model, data = self._robot.model, self._data
        pin.forwardKinematics(model, data, self._q)
        return {
            contact.point: (
                pin.updateFramePlacement(model, data, self._robot.point(contact.point)).copy(),
                contact.load,
            )
            for contact in self._standing()
        }

    def sample_after(self, t: float, dcm: Array, loads: Mapping[str, float]) -> MotionSample:
        """State at a time [s], pushed if need be.

        Args:
            t: time [s].
            dcm: measured ξ (2,), seen from the feet that stand in the own state [m].
            loads: measured normal forces of the feet [N].
        """
        before, self._follows = self._follows, self._has_to_catch(dcm)
        if self._follows:
            com = pin.centerOfMass(self._robot.model, self._data, self._q, self._v)
            own = (com + self._data.vcom[0] / self._omega)[:2]
            share = OBSERVER_RATE * self._omega * self._controller.tick.period if before else FIRST_SHARE
            self._push(share * self._omega * (dcm - own))
        return self.sample(t, loads)

    def _standing(self):  # type: ignore[no-untyped-def]
        return [contact for contact in self._controller.stack.contacts if contact.mode == "fixed"]

    def _has_to_catch(self, dcm: Array) -> bool:
        """Whether ξ (2,) is out of the support, or a foot is in the air."""
        standing = self.stances()
        if len(standing) < len(self._robot.feet):
            return True
        corners = [(place.act(corner))[:2] for foot, (place, _) in standing.items() for corner in self._robot.sole(foot)]
        return bool(Polygon.hull(np.array(corners)).margin(dcm) < 0.0)

    def _push(self, change: Array) -> None:
        """Change the horizontal velocity of the centre of mass (2,) [m/s], by least kinetic energy; contacts stay."""
        model, data = self._robot.model, self._data
        mass = pin.crba(model, data, self._q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        rows = [pin.jacobianCenterOfMass(model, data, self._q)[:2]]
        for contact in self._standing():
            rows.append(
                pin.computeFrameJacobian(
                    model, data, self._q, self._robot.point(contact.point), pin.LOCAL_WORLD_ALIGNED
                )
            )
        J = np.vstack(rows)
        wanted = np.zeros(len(J))
        wanted[:2] = change
        inverse = np.linalg.solve(mass, J.T)
        self._v = self._v + inverse @ np.linalg.lstsq(J @ inverse, wanted, rcond=None)[0]
