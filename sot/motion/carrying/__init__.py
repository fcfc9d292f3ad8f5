"""Motions without a human in which a box is carried, or a cart pushed, on the robot's own steps."""
