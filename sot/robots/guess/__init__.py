"""The robot file of any humanoid's model, guessed: each part from what the model's links, axes and geometry say."""

from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.guess import Guess, guess
from sot.robots.guess.robot_file import robot_file

__all__ = ["Evidence", "Guess", "Sureness", "guess", "robot_file"]
