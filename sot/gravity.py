"""Gravity, as plans, control and physics have it."""

GRAVITY = 9.81
"""Acceleration of free fall [m/s²]."""
