"""Sensors in, state out: where the robot is and how it moves, from what its own sensors say."""

from sot.estimation.contact_filter import ContactFilter
from sot.estimation.estimator import LEVEL_GROUND, Estimator, Footing
from sot.estimation.noise import FilterNoise

__all__ = ["LEVEL_GROUND", "ContactFilter", "Estimator", "FilterNoise", "Footing"]
