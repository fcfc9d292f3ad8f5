"""Dancer and robot side by side: what becomes of a dancer's legs."""
