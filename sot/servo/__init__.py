"""Controllers of robots whose joints have servos."""

from sot.servo.integrated_stack import IntegratedStack
from sot.servo.stabiliser import Stabiliser

__all__ = ["IntegratedStack", "Stabiliser"]
