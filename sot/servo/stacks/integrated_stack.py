"""A stack of tasks for a robot that takes positions: its accelerations integrated twice, Otani IV."""

from collections.abc import Callable, Mapping

import numpy as np
import pinocchio as pin

from sot.control.controller import Command, Controller
from sot.motion.trajectory import MotionSample

Array = np.ndarray


class IntegratedStack:
    """A stack that runs on a state of its own, which its accelerations move; what the robot does, it does not see.

    Contacts hold in that state, and the zero-moment point is that of the stack's own forces. Steps happen as planned:
    no floor stops a foot there that waits for its load, and it would sink.

    Args:
        controller: of the stack, at the period of the calls.
        q, v: state to begin with (nq,), (nv,).
        watch: told every command.
    """

    def __init__(
        self, controller: Controller, q: Array, v: Array, watch: Callable[[Command], object] | None = None
    ) -> None:
        self._controller, self._q, self._v = controller, q.copy(), v.copy()
        self._zmp, self._watch = np.zeros(2), watch

    def sample(self, t: float, loads: Mapping[str, float] | None = None) -> MotionSample:
        """State at a time [s], one period after the last one that was asked for.

        Args:
            t: time [s].
            loads: measured normal forces of the contacts [N]: of a schedule that waits for them.
        """
        controller, q, v = self._controller, self._q, self._v
        command, tick = controller(t, q, v, loads), controller.tick
        if self._watch is not None:
            self._watch(command)
        a = command.acceleration
        self._zmp = np.where(np.isfinite(command.zmp), command.zmp, self._zmp)
        forward = tick.com_jacobian @ a + tick.com_drift
        sample = MotionSample(q, v, a, tick.com.copy(), tick.com_velocity.copy(), forward, self._zmp)
        self._v = v + tick.period * a
        self._q = pin.integrate(controller.system.model, q, tick.period * self._v)
        return sample
