"""Bin Hammam 2015: constrained resolved acceleration control, as printed, mended, and beside this project's cascade."""
