"""Stacks of tasks that lead a robot which takes positions, on a state of their own."""
