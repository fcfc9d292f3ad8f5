"""Runnable studies and the command line."""

from scenarios.inputs.clips import find_clip
from scenarios.scenario import Scenario

__all__ = ["Scenario", "find_clip"]
