"""Feet: when each one stands, where it steps, and the way that it swings or slides."""
