"""Resolved acceleration (Bin Hammam 2015) and its forerunner (Dariush 2009): weights that stand in for limits."""
