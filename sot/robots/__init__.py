"""Robots: one model file and one text file each, read into an immutable `Robot`."""

from sot.robots.robot import Robot, robots

__all__ = ["Robot", "robots"]
