"""Controllers of robots whose joints have servos."""

from sot.servo.stabiliser import Stabiliser

__all__ = ["Stabiliser"]
