"""Human motion: from a file of joint angles to a human with names and frames."""

from sot.motion.capture import Capture
from sot.motion.human import SEGMENTS, Human
from sot.motion.readers import read
from sot.motion.skeleton import recognise

__all__ = ["SEGMENTS", "Capture", "Human", "read", "recognise"]
