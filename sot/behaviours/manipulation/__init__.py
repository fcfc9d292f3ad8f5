"""Contacts that are made and broken as a demonstration says, when the robot is ready: Otani, Algorithm 1."""
