"""Human motion to robot motion: from a file of joint angles to a human with names, and on to what a robot can do."""

from sot.motion.climb import climb
from sot.motion.edit import Edit
from sot.motion.human.capture import Capture
from sot.motion.human.formats.readers import read
from sot.motion.human.human import SEGMENTS, Human
from sot.motion.human.skeleton import recognise
from sot.motion.plan import Plan, plan
from sot.motion.trajectory import Motion, MotionSample, Track
from sot.motion.walk import walk

__all__ = [
    "SEGMENTS",
    "Capture",
    "Edit",
    "Human",
    "Motion",
    "MotionSample",
    "Plan",
    "Track",
    "climb",
    "plan",
    "read",
    "recognise",
    "walk",
]
