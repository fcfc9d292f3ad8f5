"""Robot motions in the files of trackers, retargeters and data sets: written from a run, and read back safely."""
