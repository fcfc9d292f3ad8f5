"""Robots controlled in position on compliant feet, Kim & Oh 4 and 5.2: identification, pushes."""
