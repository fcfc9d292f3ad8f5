"""The control tick: tasks over contacts, ordered in a stack, become rows; the solver's answer becomes torques."""

from sot.control.contact import Contact
from sot.control.controller import Command, Controller
from sot.control.load import Carried, KnownWrench
from sot.control.pose import Pose, PoseReference
from sot.control.quantities.frames import FrameState
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.control.task import MotionTask, Task
from sot.control.tick import Tick

__all__ = [
    "Carried",
    "Command",
    "Contact",
    "Controller",
    "FrameState",
    "KnownWrench",
    "MotionTask",
    "Pose",
    "PoseReference",
    "Schedule",
    "Stack",
    "Task",
    "Tick",
]
