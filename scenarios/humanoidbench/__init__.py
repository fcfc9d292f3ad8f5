"""Scenes with the rules of HumanoidBench, in the robot's size."""
