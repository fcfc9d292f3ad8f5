"""Robots: one model file and one text file each, read into an immutable `Robot`."""

from sot.robots.robot import Robot, robot_names, shipped_robot_names

__all__ = ["Robot", "robot_names", "shipped_robot_names"]
