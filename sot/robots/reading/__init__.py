"""From any model file to one tree of numbers, and from it to MuJoCo's and Pinocchio's model."""

from sot.robots.reading.read_model import ModelReading, models_of, read_model

__all__ = ["ModelReading", "models_of", "read_model"]
