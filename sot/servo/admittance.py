"""Feet that yield until they carry what they are to: ankle and leg-length admittance, after Caron 2019."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp

import numpy as np

from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.servo.load_sharing import FootLoad

Array = np.ndarray


@dataclass(frozen=True, slots=True)
class AdmittanceGains:
    """Rates of the feet's yielding, in √(g / l).

    Attributes:
        ankle: rate at which the moment that a foot lacks comes about, for the stiffness that is known.
        leg: rate at which the difference of the feet's loads does.
        leak: rate at which the offsets go back.
    """

    ankle: float = 1.8
    leg: float = 0.3
    leak: float = 0.3


class FootAdmittance:
    """Offsets of the feet that grow as long as they do not carry what they are to.

    A foot turns at −a (M* − M) about both horizontal axes of its frame, and of two that stand, the legs' lengths change
    by what the feet lack more or less than each other, a_z (F* − F). The gains are the rates a K, with 1 / K the
    compliance of leg and bush in series: how fast the moment comes about does not depend on how soft they are. All of
    it leaks away.

    A bush gives K (φ + t_r φ̇), so that turning a foot moves its moment at once, by K t_r times the rate. Fed back, that
    part does not integrate but goes round the loop at the rate of the servos' commands, and grows there if the servos
    are fast. A filter of the wrenches with the time constant t_r leaves K φ, and the loop is the integrator it is meant
    to be.

    Args:
        robot: whose feet.
        length: height l of the centre of mass above the feet [m].
        gains: see there.
        relaxation_time: t_r of the bushes, damping over stiffness [s].
        period: between calls [s].
    """

    def __init__(
        self, robot: Robot, length: float, gains: AdmittanceGains, relaxation_time: float, period: float
    ) -> None:
        rate = float(np.sqrt(GRAVITY / length))
        self._passed = 1.0 - exp(-period / relaxation_time) if relaxation_time > 0.0 else 1.0
        self._elastic: dict[str, Array] = {}
        self._gains = period * rate * np.array([gains.ankle, gains.ankle, gains.leg])
        self._kept = 1.0 - gains.leak * rate * period
        self.offsets = {foot: np.zeros(3) for foot in robot.feet}
        """Roll, pitch [rad] and height [m] of each foot, (3,)."""

    def __call__(
        self, wanted: Mapping[str, FootLoad], measured: Mapping[str, Array], compliance: Mapping[str, Array]
    ) -> dict[str, Array]:
        """Offsets after another period.

        Args:
            compliance: foot -> 1 / K of roll, pitch [rad/(N m)] and height [m/N], shape (3,).
            wanted: of the feet that stand.
            measured: foot -> force and moment of sole on foot (6,), in the axes of the foot frame, about its origin.
        """
        for foot, wrench in measured.items():
            before = self._elastic.get(foot, wrench)
            self._elastic[foot] = before + self._passed * (wrench - before)
        elastic = self._elastic
        lacks = {foot: load.force[2] - elastic[foot][2] for foot, load in wanted.items()}
        common = sum(lacks.values()) / max(len(lacks), 1)
        for foot, offset in self.offsets.items():
            offset *= self._kept
            if foot in wanted:
                moment = wanted[foot].moment - elastic[foot][3:]
                offset -= self._gains * compliance[foot] * np.array([moment[0], moment[1], lacks[foot] - common])
        return self.offsets
