"""Schedules that react while the robot moves: stepping, sliding, recovery after a push; and their rehearsal."""
