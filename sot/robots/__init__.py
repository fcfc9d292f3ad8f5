"""Robots and things: one model file and one text file each; what of them may touch, and what they make together."""

from sot.robots.robot import Robot, robot_names, shipped_robot_names
from sot.robots.surface import FLOOR, Surface
from sot.robots.system import System
from sot.robots.things import Thing, thing_names

__all__ = ["FLOOR", "Robot", "Surface", "System", "Thing", "robot_names", "shipped_robot_names", "thing_names"]
