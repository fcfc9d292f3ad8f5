"""The damping controller: sway on compliant feet is damped by the centre of mass, from the zero-moment point alone."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sot.motion.feet.contacts import Phase
from sot.servo.pendulum import StateSpace
from sot.servo.pole_placement import DampingDesign

Array = np.ndarray

AXES = ("x", "y")


@dataclass(frozen=True)
class PlaneDesigns:
    """The designs of one plane, on both feet and on one."""

    double: DampingDesign
    single: DampingDesign


class DampingController:
    """Shifts the centre of mass against the sway, Kim & Oh Figure 14; one pole placement a plane.

    Between double and single support all gains and the model are blended: nothing jumps.

    Args:
        planes: the designs for x and y.
        single_share: how far the robot stands on one foot at a time [s], 0 (on both) to 1.
        reach: largest shift along x and y that is ever asked for (2,) [m].
    """

    def __init__(
        self, planes: tuple[PlaneDesigns, PlaneDesigns], single_share: Callable[[float], float], reach: Array
    ) -> None:
        self._planes = [_Plane(plane, float(room)) for plane, room in zip(planes, reach, strict=True)]
        self._single_share = single_share

    def __call__(self, t: float, zmp: Array) -> Array:
        """The shift (2,) [m].

        Args:
            t: the time [s].
            zmp: measured zero-moment point less the planned one (2,) [m]; nan where no foot carries anything.
        """
        share = self._single_share(t)
        return np.array([plane(value, share) for plane, value in zip(self._planes, zmp.tolist(), strict=True)])


class _Plane:
    def __init__(self, designs: PlaneDesigns, reach: float) -> None:
        self._double, self._single, self._reach = designs.double, designs.single, reach
        self._share = -1.0
        self._state, self._input = np.zeros(len(designs.double.feedback[0])), 0.0

    def __call__(self, zmp: float, share: float) -> float:
        if share != self._share:
            self._blend(share)
        A, B, C, D = self._system
        state = self._state
        if np.isfinite(zmp):
            state = state + self._correction * (zmp - C @ state - D * self._input)
        most = self._reach / self._length
        self._input = min(max(float(-self._feedback @ state), -most), most)
        angle = float(self._reference @ state)
        self._state = A @ state + B * self._input
        return self._length * min(max(angle, -most), most)

    def _blend(self, share: float) -> None:
        def mixed(of: Callable[[DampingDesign], Array]) -> Array:
            value: Array = (1.0 - share) * of(self._double) + share * of(self._single)
            return value

        A, B, C, D = map(
            mixed, (lambda d: d.system.A, lambda d: d.system.B, lambda d: d.system.C, lambda d: d.system.D)
        )
        self._system = StateSpace(A, B[:, 0], C[0], D[0, 0])
        self._feedback, self._reference = mixed(lambda design: design.feedback)[0], mixed(lambda d: d.reference)[0]
        self._correction = mixed(lambda design: design.correction)[:, 0]
        self._length = float(mixed(lambda design: np.array(design.pendulum.length)))
        self._share = share


def single_support_share(phases: Sequence[Phase], ramp: float) -> Callable[[float], float]:
    """How far a robot stands on one foot, by time [s]: 0 in double support, 1 in single support, linear between.

    A ramp of a length [s] begins with each phase, so that a foot that has just landed counts little at first.
    """
    starts = np.array([phase.start for phase in phases])
    shares = np.array([0.0 if len(phase.feet) > 1 else 1.0 for phase in phases])

    def share(t: float) -> float:
        k = max(int(np.searchsorted(starts, t, side="right")) - 1, 0)
        if k == 0 or shares[k] == shares[k - 1]:
            return float(shares[k])
        passed = min((t - starts[k]) / ramp, 1.0)
        return float(shares[k - 1] + passed * (shares[k] - shares[k - 1]))

    return share
