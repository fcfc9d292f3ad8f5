"""Things that a robot walks with: a box carried from stand to stand."""
