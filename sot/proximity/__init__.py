"""How near parts of a robot come to one another and to things."""

from sot.proximity.distances import DistanceMotion, Proximity
from sot.proximity.overlaps import overlap_remarks

__all__ = ["DistanceMotion", "Proximity", "overlap_remarks"]
