"""Controllers of robots whose joints have servos."""

from sot.servo.planned import PlannedTargets

__all__ = ["PlannedTargets"]
