"""Whole libraries of clips: danced in a batch, exported to the files of trackers, told on one page."""
